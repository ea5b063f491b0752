/* SPDX-License-Identifier: MIT */
/*
 * Fuzz target: any bytes as a checkpoint. What must hold: what is not whole is refused; what was changed and sealed again
 * loads, or is refused as RB_ERR_INPUT, RB_ERR_SCENE or RB_ERR_MEMORY; everything taken is given back.
 *
 * The first byte chooses: the file itself, the world or the script. For the last two the rest are changes of a true one:
 * a place of three bytes and a new value each, the last one maybe an end.
 */
#include <stdlib.h>
#include <string.h>

#include <rbsim/model.h>

#include "app/checkpoint.h"
#include "base/memory.h"
#include "script/hooks.h"
#include "script/keep.h"
#include "script/load.h"
#include "method/save.h"

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size);

static const char source[] =
	"world { duration = 2, gravity = {0, 0, -9.81}, frame_rate = 10 }\n"
	"local m = material { name = 'm', density = 1000, friction = 0.4, restitution = 0.3 }\n"
	"plane { normal = {0, 0, 1}, size = {3, 3}, material = m }\n"
	"for i = 0, 2 do sphere { radius = 0.1, position = {0.001 * i, 0, 0.1 + 0.2 * i}, material "
	"= m } end\n"
	"for i = 0, 49 do sphere { radius = 0.01, position = {-1 + 0.04 * i, 1, 1 + 0.01 * i}, "
	"material = m } end\n"
	"state.a = {1, 2.5, 'x', {true, vec3(1, 2, 3)}}\n"
	"state.b = state.a\n"
	"expect_always('yes', function() return true end)\n";

struct bench {
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_model *model;
	struct rb_world *world;
};

static void open_bench(struct bench *bench)
{
	const struct rb_source_file file = {
		.name = "s.lua", .text = source, .size_bytes = sizeof source - 1};
	const struct rb_script_options options = {.path = "s.lua", .files = &file, .file_count = 1};
	const struct rb_world_options world = {.threads = 1, .keep_events = true};
	struct rb_mistakes mistakes = {0};
	struct rb_error err;

	if (rb_script_load(&bench->script, &bench->scene, &mistakes, &options, &err) != RB_OK ||
	    rb_model_create(&bench->model, &bench->scene, &mistakes, &err) != RB_OK)
		abort();
	const struct rb_world_hooks hooks = rb_script_hooks(bench->script);
	if (rb_world_create(&bench->world, bench->model, &world, &hooks, &err) != RB_OK)
		abort();
	rb_mistakes_release(&mistakes);
}

static void close_bench(struct bench *bench)
{
	rb_world_destroy(bench->world);
	rb_model_destroy(bench->model);
	rb_script_destroy(bench->script);
	rb_scene_release(&bench->scene);
}

/* World and script in mid-run, made once. */
static struct rb_pack saved[2];

static void save_once(void)
{
	struct bench bench;
	struct rb_frame frame = {0};

	if (saved[0].bytes)
		return;
	open_bench(&bench);
	for (int k = 0; k < 6; k++)
		if (rb_world_fill_frame(bench.world, &frame, NULL) != RB_OK ||
		    rb_world_step_frame(bench.world, NULL) != RB_OK)
			abort();
	if (rb_world_fill_frame(bench.world, &frame, NULL) != RB_OK ||
	    rb_world_pack(bench.world, &saved[0], NULL) != RB_OK ||
	    rb_script_pack(bench.script, &saved[1], NULL) != RB_OK)
		abort();
	rb_memory_free(frame.events);
	rb_memory_free(frame.contacts);
	close_bench(&bench);
}

static void load_changed(int which, const unsigned char *bytes, size_t size)
{
	struct rb_pack pack = {.loading = true, .size = saved[which].size};
	struct bench bench;
	struct rb_error err;

	pack.bytes = rb_memory_take(pack.size, 1);
	if (!pack.bytes)
		abort();
	memcpy(pack.bytes, saved[which].bytes, pack.size);
	for (; size >= 4; bytes += 4, size -= 4) {
		const size_t at = bytes[0] | (size_t)bytes[1] << 8 | (size_t)bytes[2] << 16;

		pack.bytes[at % saved[which].size] = bytes[3];
	}
	if (size == 3)
		pack.size = (bytes[0] | (size_t)bytes[1] << 8) % (pack.size + 1);
	open_bench(&bench);
	const enum rb_status status = which == 0 ? rb_world_pack(bench.world, &pack, &err)
	                                         : rb_script_pack(bench.script, &pack, &err);
	if (status != RB_OK && status != RB_ERR_INPUT && status != RB_ERR_SCENE &&
	    status != RB_ERR_MEMORY)
		abort();
	close_bench(&bench);
	rb_memory_free(pack.bytes);
}

static void parse(const unsigned char *bytes, size_t size)
{
	unsigned char *const copy = rb_memory_take(size + 1, 1);
	struct rb_checkpoint checkpoint;

	if (!copy)
		abort();
	memcpy(copy, bytes, size);
	/* nobody guesses four hashes */
	if (rb_checkpoint_parse(&checkpoint, copy, size, "fuzz", NULL) != RB_ERR_INPUT)
		abort();
	rb_checkpoint_release(&checkpoint);
}

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size)
{
	if (size == 0)
		return 0;
	save_once();
	const struct rb_memory_counts before = rb_memory_counts();
	if (bytes[0] % 3 == 2)
		parse(bytes + 1, size - 1);
	else
		load_changed(bytes[0] % 3, bytes + 1, size - 1);
	const struct rb_memory_counts after = rb_memory_counts();
	if (after.taken - before.taken != after.freed - before.freed)
		abort();
	return 0;
}
