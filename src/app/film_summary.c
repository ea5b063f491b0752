/* SPDX-License-Identifier: MIT */
#include "app/film_summary.h"

#include <inttypes.h>

#include "app/films_inside.h"
#include "base/visible.h"

/* "film.mp4 and frames/%05d.png, camera 'main'" */
static void print_name(FILE *file, const struct film *film)
{
	const struct rb_camera_def *const camera = &film->camera;

	rb_print(file, "%s%s%s, %s", camera->video ? camera->video : "",
	         camera->video && camera->png ? " and " : "", camera->png ? camera->png : "",
	         film->label);
}

void rb_films_print_plan(FILE *file, const struct rb_films *films)
{
	for (int i = 0; i < rb_films_count(films); i++) {
		const struct film *const film = &films->film[i];
		const uint64_t count = rb_schedule_count(&film->schedule);
		rb_print(file, "  film        ");
		print_name(file, film);
		rb_print(file, ": %" PRIu64 " %s of %d x %d pixels\n", count,
		         rb_text_plural(count, "picture", "pictures"), film->camera.size_px[0],
		         film->camera.size_px[1]);
	}
}

void rb_films_print(FILE *file, const struct rb_films *films)
{
	char size[32];

	for (int i = 0; i < rb_films_count(films); i++) {
		const struct film *const film = &films->film[i];
		const struct rb_film_tally *const t = &film->tally;
		const double busy = (double)(t->draw_ns + t->read_ns + t->png_ns + t->pipe_ns);
		const double percent = busy > 0 ? 100 / busy : 0;

		rb_print(file, "  film          ");
		print_name(file, film);
		rb_print(file, ": %" PRIu64 " %s, %s", t->pictures,
		         rb_text_plural(t->pictures, "picture", "pictures"),
		         rb_text_bytes(t->bytes, size));
		if (t->pictures > 0)
			rb_print(file,
			         "; drawing %.0f %%, reading %.0f %%, PNG %.0f %%, pipe %.0f %%",
			         percent * (double)t->draw_ns, percent * (double)t->read_ns,
			         percent * (double)t->png_ns, percent * (double)t->pipe_ns);
		if (t->left_out > 0)
			rb_print(file, "; %" PRIu64 " left out by command", t->left_out);
		rb_print(file, "%s\n",
		         film->status              ? " (failed)"
		         : rb_film_is_cut_short(t) ? " (cut short)"
		                                   : "");
	}
}

void rb_films_print_json(struct rb_json *json, const struct rb_films *films)
{
	rb_json_open(json, "films", '[');
	for (int i = 0; i < rb_films_count(films); i++) {
		const struct film *const film = &films->film[i];
		const struct rb_film_tally *const t = &film->tally;
		rb_json_open(json, NULL, '{');
		rb_json_text(json, "camera", film->camera.name);
		rb_json_text(json, "video", film->camera.video);
		rb_json_text(json, "png", film->camera.png);
		rb_json_text(json, "status",
		             film->status              ? "failed"
		             : rb_film_is_cut_short(t) ? "cut short"
		                                       : "complete");
		rb_json_count(json, "pictures", t->pictures);
		rb_json_count(json, "picture_count", t->picture_count);
		rb_json_count(json, "left_out", t->left_out);
		rb_json_count(json, "bytes", t->bytes);
		rb_json_number(json, "draw_time", (double)t->draw_ns * 1e-9);
		rb_json_number(json, "read_time", (double)t->read_ns * 1e-9);
		rb_json_number(json, "png_time", (double)t->png_ns * 1e-9);
		rb_json_number(json, "pipe_time", (double)t->pipe_ns * 1e-9);
		rb_json_number(json, "wait_time", (double)t->wait_ns * 1e-9);
		rb_json_close(json, '}');
	}
	rb_json_close(json, ']');
}
