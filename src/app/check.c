/* SPDX-License-Identifier: MIT */
#include "app/check.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "app/film_summary.h"
#include "app/json.h"
#include "app/needs.h"
#include "app/progress.h"
#include "app/simulate.h"
#include "base/visible.h"
#include "force/gravitation.h"
#include "located/needed_parts.h"
#include "model/descriptor.h"
#include "model/element.h"
#include "model/mobility.h"
#include "model/scale.h"
#include "model/features.h"
#include "classic/stage_list.h"
#include "method/method.h"
#include "stepped/stages.h"

static const char *material_name(const struct rb_scene *scene, int material)
{
	const char *name = scene->materials[material].name;

	return name ? name : material == 0 ? "(default)" : "(unnamed)";
}

static struct rb_pair_material pair_of(const struct rb_model *model, int a, int b)
{
	return model->pair_materials[(size_t)a * (size_t)model->material_count + (size_t)b];
}

static void print_materials(const struct rb_loaded *loaded)
{
	const struct rb_model *const model = loaded->model;

	rb_print(stdout, "materials\n");
	for (int a = 0; a < model->material_count; a++)
		for (int b = a; b < model->material_count; b++) {
			const struct rb_pair_material pair = pair_of(model, a, b);
			rb_print(stdout, "  %s on %s: friction %g, restitution %g\n",
			         material_name(&loaded->scene, a), material_name(&loaded->scene, b),
			         pair.friction, pair.restitution);
		}
}

static int driven_count(const struct rb_model *model)
{
	int count = 0;

	for (int i = 0; model->driven && i < model->body_count; i++)
		count += model->driven[i];
	return count;
}

/* Driven bodies by name, and what of their motion has to be differenced. */
static void print_driven(const struct rb_model *model)
{
	enum { SHOWN = 10 };
	int shown = 0;
	char label[64];

	for (int i = 0; model->driven && i < model->body_count; i++) {
		const int id = model->id_of[i];
		const struct rb_body_def *body = &model->scene->bodies[id];
		const bool turn = body->motion_turns && !body->motion_gives_angular_velocity;
		if (!model->driven[i] || shown++ >= SHOWN)
			continue;
		const bool shift = !body->motion_gives_velocity;
		rb_print(stdout, "  %-11s %s%s%s%s%s%s\n", shown == 1 ? "driven" : "",
		         rb_scene_body_label(model->scene, id, label), shift || turn ? ": " : "",
		         shift ? "velocity" : "", shift && turn ? " and " : "",
		         turn ? "angular velocity" : "", shift || turn ? " differenced" : "");
	}
	if (shown > SHOWN)
		rb_print(stdout, "  %-11s %d more\n", "", shown - SHOWN);
}

/* Bodies that gravitation treats as if they were points. */
static int extended_count(const struct rb_model *model)
{
	int count = 0;

	for (int i = 0; i < model->body_count + model->static_count; i++)
		count += model->shape[i].kind != RB_SHAPE_SPHERE &&
		         (model->attraction[i] > 0 ||
		          (i < model->body_count && rb_gravitation_attracts(model, i)));
	return count;
}

static bool has_driven_center(const struct rb_model *model)
{
	for (int i = 0; model->driven && i < model->body_count; i++)
		if (model->driven[i] && model->attraction[i] > 0)
			return true;
	return false;
}

/*
 * How attraction is summed, and about what that costs on an idle processor: the time of a pair is
 * that of math/attract; a body in the tree takes as long as 2,100 pairs (an even cube of 100,000).
 */
static void print_sums(const struct rb_model *model, int attracted)
{
	static const double pair_s = 1e-9, tree_s = 2.1e-6;
	const double pairs = (double)attracted * model->attractor_count;
	const bool by_tree = rb_gravitation_by_tree(model);

	if (model->method != RB_METHOD_STEPPED)
		rb_print(stdout,
		         "              located: every two of them, to rounding; %.2g s an "
		         "evaluation of forces\n",
		         pair_s * pairs);
	if (model->method == RB_METHOD_LOCATED)
		return;
	if (by_tree)
		rb_print(stdout,
		         "              steps: a tree, opening_angle %g; %.2g s a step, and its "
		         "error is told\n",
		         model->scene->world.gravitation.opening_angle,
		         tree_s * (model->body_count + model->static_count));
	else
		rb_print(stdout, "              steps: pair by pair; %.2g s a step\n",
		         pair_s * pairs);
}

/* Who attracts whom, and what that does not conserve. */
static void print_gravitation(const struct rb_model *model)
{
	const struct rb_gravitation_def *const def = &model->scene->world.gravitation;
	int attracted = 0;

	if (!(model->features & RB_FEATURE_GRAVITATION))
		return;
	for (int i = 0; i < model->body_count; i++)
		attracted += rb_gravitation_attracts(model, i);
	rb_print(
		stdout, "  gravitation %d %s, %d %s attracted; G %g m^3/(kg s^2), softening %g m\n",
		model->attractor_count,
		rb_text_plural((uint64_t)model->attractor_count, "body attracts", "bodies attract"),
		attracted, attracted == 1 ? "is" : "are", def->constant, def->softening_m);
	if (model->center_count > 0)
		rb_print(stdout, "              %d %s held or driven: momentum%s not conserved\n",
		         model->center_count,
		         rb_text_plural((uint64_t)model->center_count, "centre is", "centres are"),
		         has_driven_center(model) ? " and energy are" : " is");
	if (!model->attracts_by_mass)
		rb_print(stdout,
		         "              gravitational masses are not the masses: action is not "
		         "reaction, momentum and energy are not conserved\n");
	print_sums(model, attracted);
	const int extended = extended_count(model);
	if (extended > 0)
		rb_print(stdout,
		         "              %d %s no %s: gravitation acts at centres of mass, without "
		         "torque\n",
		         extended, rb_text_plural((uint64_t)extended, "body is", "bodies are"),
		         extended == 1 ? "sphere" : "spheres");
}

static void print_bodies(const struct rb_model *model)
{
	const struct rb_scene *const scene = model->scene;
	const int driven = driven_count(model);
	int counts[RB_SHAPE_KIND_COUNT] = {0};
	int elements[RB_ELEMENT_KINDS_MAX];
	char forces[RB_FORCES_TEXT_SIZE], shapes[160];

	rb_print(stdout, "  bodies      %d moving", model->body_count);
	if (driven > 0)
		rb_print(stdout, " (%d of them driven)", driven);
	rb_print(stdout, ", %d static\n", model->static_count);
	for (int i = 0; i < scene->body_count; i++)
		counts[scene->bodies[i].shape.kind]++;
	if (*rb_text_shapes(counts, shapes))
		rb_print(stdout, "  shapes      %s\n", shapes);
	print_driven(model);
	rb_scene_count_elements(scene, elements);
	rb_text_forces(elements, scene->field_count, forces);
	if (*forces)
		rb_print(stdout, "  forces      %s\n", forces);
	print_gravitation(model);
}

/* Joints, and what they leave free. */
static void print_joints(const struct rb_model *model)
{
	char text[RB_JOINTS_TEXT_SIZE];
	int kinds[RB_JOINT_KIND_COUNT] = {0};
	struct rb_mobility mobility;

	if (model->scene->joint_count == 0)
		return;
	for (int k = 0; k < model->scene->joint_count; k++)
		kinds[model->scene->joints[k].kind]++;
	rb_print(stdout, "  joints      %s\n", rb_text_joints(kinds, text));
	if (rb_mobility_of(&mobility, model, NULL) != RB_OK)
		return;
	if (!mobility.counted)
		rb_print(stdout,
		         "  freedoms    %d or more: %d rows of joints are too many to say "
		         "which are redundant\n",
		         mobility.freedoms > 0 ? mobility.freedoms : 0, mobility.rows);
	else
		rb_print(stdout,
		         "  freedoms    %d at the start; joints have %d %s, of which %d %s\n",
		         mobility.freedoms, mobility.rows,
		         rb_text_plural((uint64_t)mobility.rows, "row", "rows"), mobility.redundant,
		         mobility.redundant == 1 ? "is redundant" : "are redundant");
}

/* Parts of a method; classic/stage_list prints those of the classic one. */
static void print_parts(const struct rb_model *model)
{
	const struct rb_method *const method = rb_model_method_row(model);
	int count = 0;
	const struct rb_method_part *const part = method->parts ? method->parts(&count) : NULL;

	if (part)
		puts(method->parts_title);
	for (int k = 0; k < count; k++) {
		const bool on = rb_method_part_is_used(&part[k], model);

		rb_print(stdout, "  %c %-16s %s\n", on ? '+' : '-', part[k].name,
		         on ? part[k].what : rb_method_part_why_not(&part[k], model));
	}
}

/* What the cameras will make, or why they can't. */
static void print_films(struct rb_loaded *loaded, const struct rb_options *options)
{
	const struct rb_films_wish wish = rb_films_wish_of_run(loaded, options);
	struct rb_films *films = NULL;
	struct rb_error refusal;

	rb_films_tell_unrecorded(loaded);
	if (options->no_render)
		return;
	if (rb_films_create(&films, loaded, &wish, &refusal))
		rb_print(stdout, "  but         %s\n", refusal.text);
	rb_films_print_plan(stdout, films);
	rb_films_destroy(films);
}

static void print_time(const struct rb_estimate *run)
{
	char text[32];

	if (isnan(run->run_s))
		return;
	rb_progress_duration(text, sizeof text, run->run_s);
	if (run->at_least)
		rb_print(stdout, "  time        at least %s: tried as far as %.3g s of the run\n",
		         text, run->reached_s);
	else
		rb_print(stdout, "  time        about %s\n", text);
}

static void print_text(struct rb_loaded *loaded, const struct rb_options *options,
                       const struct rb_run_info *info, const struct rb_needs *needs)
{
	struct rb_error refusal;
	const struct rb_model *const model = loaded->model;
	const char *title = loaded->scene.world.title;
	char size[32], tolerance[96];

	rb_print(stdout, "%s%s%s\n", loaded->scene.file, title && *title ? ": " : "",
	         title ? title : "");
	print_bodies(model);
	rb_print(stdout,
	         "  run         %g s in %" PRIu64 " %s at %g per second, %" PRIu64
	         " %s of at most %g s, seed %" PRIu64 "\n",
	         model->duration_s, model->frame_count,
	         rb_text_plural(model->frame_count, "frame", "frames"), model->frame_rate,
	         needs->steps, rb_text_plural(needs->steps, "step", "steps"), model->time_step_s,
	         loaded->scene.world.seed);
	print_joints(model);
	print_time(&needs->run);
	rb_print(stdout, "  method      %s, rollback %s, %d %s\n", info->method, info->rollback,
	         info->threads, rb_text_plural((uint64_t)info->threads, "thread", "threads"));
	rb_print(stdout, "  tolerance   %s\n",
	         rb_text_tolerance(model->tolerance_m, model->stepped_tolerance_m, 6, tolerance));
	if (rb_model_may_change_method(model) && (model->features & RB_FEATURE_CONTACT))
		puts("  crowds      too dense to locate are left to steps (rbsim-scene(5))");
	rb_print(stdout,
	         "  touching    gaps within 8 ulp of the larger of coordinate and size count as "
	         "touching (here up to %.3g m);\n"
	         "              a touching pair that no force parts beyond that is in lasting "
	         "contact (rbsim-scene(5))\n",
	         8 * rb_ulp(model->coordinate_max_m));
	rb_print(stdout, "  memory      %s (tried as far as frame %" PRIu64 " of %" PRIu64 "%s)\n",
	         rb_text_bytes(needs->run.memory_bytes, size), needs->run.tried_frames,
	         model->frame_count,
	         loaded->scene.camera_count > 0 && !options->no_render ? ", without the films"
	                                                               : "");
	if (loaded->output)
		rb_print(stdout, "  disk        %s: %s\n", loaded->output,
		         rb_text_bytes(needs->disk_bytes, size));
	else
		rb_print(stdout, "  disk        nothing is recorded\n");
	if (rb_simulate_check_output(loaded, options, &refusal))
		rb_print(stdout, "  but         %s\n", refusal.text);
	print_films(loaded, options);
	print_materials(loaded);
	rb_stage_list_print_features(model, stdout);
	print_parts(model);
	rb_stage_list_print(model, stdout);
}

static void json_joints(struct rb_json *json, const struct rb_model *model)
{
	struct rb_mobility mobility;

	rb_json_count(json, "joint_count", (uint64_t)model->scene->joint_count);
	if (model->scene->joint_count == 0 || rb_mobility_of(&mobility, model, NULL) != RB_OK ||
	    !mobility.counted)
		return;
	rb_json_count(json, "freedoms", (uint64_t)mobility.freedoms);
	rb_json_count(json, "joint_rows", (uint64_t)mobility.rows);
	rb_json_count(json, "redundant_rows", (uint64_t)mobility.redundant);
}

static void json_plan(struct rb_json *json, const struct rb_model *model)
{
	int count;
	const struct rb_feature_row *const feature = rb_feature_rows(&count);

	rb_json_open(json, "features", '{');
	for (int k = 0; k < count; k++)
		rb_json_bool(json, feature[k].name, model->features & feature[k].bit);
	rb_json_close(json, '}');
	const struct rb_method *const method = rb_model_method_row(model);
	const struct rb_method_part *const part = rb_located_parts(&count);
	rb_json_open(json, "parts", '{');
	for (int k = 0; k < count; k++)
		rb_json_bool(json, part[k].name,
		             method->locates && rb_method_part_is_used(&part[k], model));
	rb_json_close(json, '}');
	rb_json_open(json, "stages", '{');
	if (method->parts && !method->locates) {
		const struct rb_method_part *const row = method->parts(&count);

		for (int k = 0; k < count; k++)
			rb_json_bool(json, row[k].name, rb_method_part_is_used(&row[k], model));
		rb_json_close(json, '}');
		return;
	}
	const struct rb_stage *const *const stage = rb_stage_list_all(&count);
	for (int k = 0; k < count; k++)
		rb_json_bool(json, stage[k]->name,
		             !method->locates && rb_stage_list_has(stage[k], model->features));
	rb_json_close(json, '}');
}

static void json_materials(struct rb_json *json, const struct rb_loaded *loaded)
{
	const struct rb_model *const model = loaded->model;

	rb_json_open(json, "materials", '[');
	for (int a = 0; a < model->material_count; a++)
		for (int b = a; b < model->material_count; b++) {
			const struct rb_pair_material pair = pair_of(model, a, b);
			rb_json_open(json, NULL, '{');
			rb_json_text(json, "a", material_name(&loaded->scene, a));
			rb_json_text(json, "b", material_name(&loaded->scene, b));
			rb_json_number(json, "friction", pair.friction);
			rb_json_number(json, "restitution", pair.restitution);
			rb_json_close(json, '}');
		}
	rb_json_close(json, ']');
}

static void json_gravitation(struct rb_json *json, const struct rb_model *model)
{
	rb_json_open(json, "gravitation", '{');
	rb_json_number(json, "G", model->scene->world.gravitation.constant);
	rb_json_number(json, "softening", model->scene->world.gravitation.softening_m);
	rb_json_count(json, "attractors", (uint64_t)model->attractor_count);
	rb_json_count(json, "centers", (uint64_t)model->center_count);
	rb_json_text(json, "steps_sum",
	             rb_gravitation_by_tree(model) ? "by a tree" : "pair by pair");
	rb_json_bool(json, "conserves_momentum",
	             model->center_count == 0 && model->attracts_by_mass);
	rb_json_bool(json, "conserves_energy",
	             model->attracts_by_mass && !has_driven_center(model));
	rb_json_close(json, '}');
}

static void print_json(const struct rb_loaded *loaded, const struct rb_run_info *info,
                       const struct rb_needs *needs, int exit_code)
{
	const struct rb_model *const model = loaded->model;
	struct rb_json json = {.file = stdout};
	int elements[RB_ELEMENT_KINDS_MAX];

	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "scene", loaded->scene.file);
	rb_json_text(&json, "title", loaded->scene.world.title);
	rb_json_text(&json, "status", "accepted");
	rb_json_count(&json, "exit_status", (uint64_t)exit_code);
	rb_json_count(&json, "bodies", (uint64_t)model->body_count);
	rb_json_count(&json, "statics", (uint64_t)model->static_count);
	rb_json_count(&json, "driven_count", (uint64_t)driven_count(model));
	rb_scene_count_elements(model->scene, elements);
	rb_json_forces(&json, elements, model->scene->field_count);
	if (model->features & RB_FEATURE_GRAVITATION)
		json_gravitation(&json, model);
	json_joints(&json, model);
	rb_json_count(&json, "frames", model->frame_count);
	rb_json_number(&json, "duration", model->duration_s);
	rb_json_number(&json, "frame_rate", model->frame_rate);
	rb_json_number(&json, "time_step", model->time_step_s);
	rb_json_count(&json, "steps", needs->steps);
	rb_json_number(&json, "tolerance", model->tolerance_m);
	rb_json_number(&json, "stepped_tolerance", model->stepped_tolerance_m);
	rb_json_number(&json, "touching", 8 * rb_ulp(model->coordinate_max_m));
	rb_json_text(&json, "method", info->method);
	rb_json_text(&json, "rollback", info->rollback);
	rb_json_count(&json, "seed", loaded->scene.world.seed);
	rb_json_count(&json, "threads", (uint64_t)info->threads);
	rb_json_text(&json, "recording", loaded->output);
	rb_json_count(&json, "memory_bytes", needs->run.memory_bytes);
	rb_json_count(&json, "tried_frames", needs->run.tried_frames);
	rb_json_number(&json, "run_seconds", needs->run.run_s);
	rb_json_bool(&json, "run_at_least", needs->run.at_least);
	rb_json_count(&json, "disk_bytes", needs->disk_bytes);
	json_plan(&json, model);
	json_materials(&json, loaded);
	rb_json_close(&json, '}');
	putchar('\n');
}

int rb_check_main(const struct rb_options *options)
{
	struct rb_loaded loaded;
	struct rb_run_texts texts = {0};
	struct rb_run_info info;
	struct rb_needs needs = {0};
	struct rb_error err;
	enum rb_status status = rb_loaded_init(&loaded, options, &err);
	int exit_code = 0;

	if (!status)
		status = rb_simulate_info(&info, &texts, &loaded, options, &err);
	if (!status)
		status = rb_needs_take(&needs, &loaded, &info, &err);
	if (status) {
		exit_code = rb_app_refuse_scene(options, &loaded, &err);
	} else {
		if (!options->json && !options->quiet)
			print_text(&loaded, options, &info, &needs);
		/* A refusal of another kind comes while it runs, if it comes. */
		if (loaded.scene.expect_refused == rb_status_exit_code(RB_ERR_SCENE))
			exit_code = rb_app_not_refused(&loaded);
		if (options->json)
			print_json(&loaded, &info, &needs, exit_code);
	}
	rb_run_texts_release(&texts);
	rb_loaded_release(&loaded);
	return rb_app_finish(options, exit_code);
}
