/* SPDX-License-Identifier: MIT */
/*
 * Fuzz target: any bytes as a scene. What must hold: loading ends within its budgets, says RB_OK or a status of the
 * scene, gives at least one mistake with the latter, and everything taken is given back; a scene that loads is sealed too
 * and its callbacks are asked once.
 */
#include <stdlib.h>
#include <string.h>

#include <rbsim/model.h>

#include "base/memory.h"
#include "flow/schedule.h"
#include "script/load.h"
#include "script/shots.h"

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size);

/* Cameras are asked once, over a frame that has no columns. */
static void shoot(struct rb_script *script, const struct rb_scene *scene,
                  const struct rb_model *model)
{
	const struct rb_frame frame = {.time_s = 0.5};
	struct rb_frame_shot shot = {0};
	struct rb_error err;

	for (int i = 0; i < scene->camera_count && i < 10; i++)
		if (rb_camera_has_functions(&scene->cameras[i]))
			(void)!rb_script_shot(script, model, &scene->cameras[i], &frame, &shot,
			                      &err);
}

static void seal(struct rb_script *script, struct rb_scene *scene)
{
	struct rb_model *model;
	struct rb_error err;
	struct rb_mistakes mistakes = {0};

	if (scene->body_count <= 100) {
		if (!(scene->world.duration_s <= 1e6))
			scene->world.duration_s = 1;
		const enum rb_status status = rb_model_create(&model, scene, &mistakes, &err);
		if (status != RB_OK && status != RB_ERR_SCENE)
			abort();
		if (status == RB_OK)
			shoot(script, scene, model);
		rb_model_destroy(model);
	}
	rb_mistakes_release(&mistakes);
}

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size)
{
	const struct rb_memory_counts before = rb_memory_counts();
	static const char png[] =
		"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\1\0\0\0\1\x08\2\0\0\0\0\0\0";
	const struct rb_source_file files[3] = {
		{.name = "fuzz.lua", .text = (const char *)bytes, .size_bytes = size},
		{.name = "part", .text = "return { radius = 1 }", .size_bytes = 21},
		{.name = "a.png", .text = png, .size_bytes = sizeof png}};
	static const char *const params[] = {"e=0.5", "n=3", "s=x", "b=true"};
	const struct rb_script_options options = {.path = "fuzz.lua",
	                                          .files = files,
	                                          .file_count = 3,
	                                          .params = params,
	                                          .param_count = size % 5 == 0 ? 4 : 0,
	                                          .load_instructions = 300000,
	                                          .callback_instructions = 30000,
	                                          .memory_bytes = (size_t)4 << 20};
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_mistakes mistakes = {0};
	struct rb_error err = {0};

	const enum rb_status status = rb_script_load(&script, &scene, &mistakes, &options, &err);
	if (status != RB_OK && status != RB_ERR_SCENE && status != RB_ERR_USAGE)
		abort();
	if ((status == RB_OK) != (mistakes.count == 0) || (status != RB_OK && err.text[0] == '\0'))
		abort();
	if (status == RB_OK)
		seal(script, &scene);
	rb_script_destroy(script);
	rb_scene_release(&scene);
	rb_mistakes_release(&mistakes);
	const struct rb_memory_counts after = rb_memory_counts();
	if (after.taken - after.freed != before.taken - before.freed)
		abort();
	return 0;
}
