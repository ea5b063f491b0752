/* SPDX-License-Identifier: MIT */
#include "app/measured.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/visible.h"

static RB_FIELDS_DEFINE(probe_course_fields, struct rb_probe_course, RB_PROBE_COURSE_FIELDS);

enum rb_status rb_measured_init(struct rb_measured *measured, const struct rb_scene *scene,
                                struct rb_error *err)
{
	const size_t results = (size_t)scene->result_count, probes = (size_t)scene->probe_count;

	*measured = (struct rb_measured){.scene = scene};
	if (results > 0)
		measured->results = rb_memory_take(results, sizeof *measured->results);
	if (probes > 0)
		measured->probes = rb_memory_take(probes, sizeof *measured->probes);
	if ((results > 0 && !measured->results) || (probes > 0 && !measured->probes)) {
		rb_measured_release(measured);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep results and probes: out of memory");
	}
	for (size_t i = 0; i < results; i++)
		measured->results[i] = (double)NAN;
	for (size_t i = 0; i < probes; i++)
		measured->probes[i] = (struct rb_probe_course){(double)NAN, (double)NAN,
		                                               (double)NAN};
	return RB_OK;
}

void rb_measured_release(struct rb_measured *measured)
{
	rb_memory_free(measured->results);
	rb_memory_free(measured->probes);
	*measured = (struct rb_measured){0};
}

enum rb_status rb_measured_take(struct rb_measured *measured, struct rb_script *script,
                                struct rb_world *world, double *values, struct rb_error *err)
{
	const enum rb_status status = rb_script_probes(script, world, values, err);

	RB_ASSERT(measured->scene != NULL);
	for (int i = 0; !status && i < measured->scene->probe_count; i++) {
		struct rb_probe_course *const probe = &measured->probes[i];

		/* fmin and fmax pass over NAN */
		probe->last = values[i];
		probe->smallest = fmin(probe->smallest, values[i]);
		probe->largest = fmax(probe->largest, values[i]);
	}
	return status;
}

enum rb_status rb_measured_end(struct rb_measured *measured, struct rb_script *script,
                               struct rb_world *world, struct rb_error *err)
{
	if (!measured->scene || measured->scene->result_count == 0)
		return RB_OK;
	measured->has_results = true;
	return rb_script_results(script, world, measured->results, err);
}

void rb_measured_pack(struct rb_measured *measured, struct rb_pack *pack)
{
	if (measured->scene)
		rb_fields_pack(probe_course_fields(), measured->probes,
		               (size_t)measured->scene->probe_count, NULL, pack);
}

/* "1.25 m", "no value". */
static const char *text_of(double value, const char *units, char out[96])
{
	if (isnan(value))
		snprintf(out, 96, "no value");
	else
		snprintf(out, 96, "%.9g%s%s", value, *units ? " " : "", units);
	return out;
}

void rb_measured_print(FILE *file, const struct rb_measured *measured)
{
	const struct rb_scene *const scene = measured->scene;
	char text[96];

	if (!scene)
		return;
	if (scene->result_count > 0)
		rb_print(file, "  results       %d%s\n", scene->result_count,
		         measured->has_results ? "" : ", not evaluated");
	for (int i = 0; measured->has_results && i < scene->result_count; i++)
		rb_print(file, "    %s: %s\n", scene->results[i].name,
		         text_of(measured->results[i], scene->results[i].units, text));
	if (scene->probe_count > 0)
		rb_print(file, "  probes        %d, at the last frame (of all frames)\n",
		         scene->probe_count);
	for (int i = 0; i < scene->probe_count; i++) {
		const struct rb_probe_course *const probe = &measured->probes[i];

		rb_print(file, "    %s: %s", scene->probes[i].name,
		         text_of(probe->last, scene->probes[i].units, text));
		if (!isnan(probe->smallest))
			rb_print(file, " (%.9g to %.9g)", probe->smallest, probe->largest);
		putc('\n', file);
	}
}

void rb_measured_print_json(struct rb_json *json, const struct rb_measured *measured)
{
	const struct rb_scene *const scene = measured->scene;

	rb_json_open(json, "results", '{');
	for (int i = 0; scene && i < scene->result_count; i++) {
		rb_json_open(json, scene->results[i].name, '{');
		rb_json_number(json, "value", measured->results[i]);
		rb_json_text(json, "unit", scene->results[i].units);
		rb_json_close(json, '}');
	}
	rb_json_close(json, '}');
	rb_json_open(json, "probes", '{');
	for (int i = 0; scene && i < scene->probe_count; i++) {
		const struct rb_probe_course *const probe = &measured->probes[i];

		rb_json_open(json, scene->probes[i].name, '{');
		rb_json_number(json, "last", probe->last);
		rb_json_number(json, "smallest", probe->smallest);
		rb_json_number(json, "largest", probe->largest);
		rb_json_text(json, "unit", scene->probes[i].units);
		rb_json_close(json, '}');
	}
	rb_json_close(json, '}');
}
