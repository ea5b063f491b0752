/* SPDX-License-Identifier: MIT */
/* src/sink/h5frames.c, h5rows.c: what of a recording grows with its frames, read back by the library */
#include "h5place.h"
#include "h5support.h"

#include "sink/h5frames.h"
#include "sink/h5rows.h"

enum { BODY_COUNT = 5 };

/* A file, a run made by hand, and what it writes. */
struct stage {
	struct file file;
	struct fake fake;
	struct rb_frames frames;
};

static void open_stage(struct stage *stage, uint64_t frames, int every, unsigned fields)
{
	open_file(&stage->file);
	fake_init(&stage->fake, BODY_COUNT, frames, true);
	stage->fake.scene.record.every = every;
	stage->fake.scene.record.fields = fields;
	rb_frames_create(&stage->file.h5, &stage->frames, &stage->fake.info);
	rb_frames_take_buffers(&stage->file.h5, &stage->frames, 0);
	if (stage->file.h5.status)
		fail_msg("%s", stage->file.h5.error.text);
}

static void close_stage(struct stage *stage)
{
	rb_frames_release(&stage->frames);
	rb_frames_release(&stage->frames);
	fake_release(&stage->fake);
	close_file(&stage->file);
}

/* Frames [from, to), written as they fill the buffers, and what is left at the end. */
static void push(struct stage *stage, uint64_t from, uint64_t to)
{
	struct rb_error err;

	for (uint64_t k = from; k < to; k++) {
		assert_ok(rb_frames_take(&stage->frames, fake_frame(&stage->fake, k), &err));
		if (rb_frames_full(&stage->frames))
			rb_frames_write(&stage->file.h5, &stage->frames);
	}
}

static void finish(struct stage *stage)
{
	rb_frames_commit(&stage->frames);
	rb_frames_write(&stage->file.h5, &stage->frames);
	rb_frames_detach(&stage->frames);
	turn_file(&stage->file, H5F_ACC_RDWR);
}

/* All numbers of a dataset, to be freed; how many rows it has. */
static void *read_all(struct stage *stage, const char *path, enum rb_h5_kind kind, hsize_t *rows)
{
	const hid_t dataset = H5Dopen2(stage->file.h5.file, path, H5P_DEFAULT);
	const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
	hsize_t size[4] = {0};

	if (space < 0)
		fail_msg("no '%s'", path);
	assert_true(H5Sget_simple_extent_dims(space, size, NULL) >= 1);
	*rows = size[0];
	void *out = rb_memory_take((size_t)H5Sget_simple_extent_npoints(space) + 1, 8);
	assert_non_null(out);
	assert_true(H5Dread(dataset, rb_h5_type(kind), H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0);
	rb_h5_done(space);
	rb_h5_done(dataset);
	return out;
}

/* Columns of bodies hold the frames of `steps`, by the formula; `tolerance` of each number. */
static void check_columns(struct stage *stage, const int64_t *steps, hsize_t count,
                          double tolerance)
{
	static const char *const names[] = {"position", "orientation", "velocity",
	                                    "angular_velocity"};
	static const int width[] = {3, 4, 3, 3};
	char path[80];
	hsize_t rows;

	for (int c = 0; c < 4; c++) {
		snprintf(path, sizeof path, "/particles/bodies/%s/value", names[c]);
		double *cells = read_all(stage, path, RB_H5_F64, &rows), *at = cells;
		assert_int_equal(rows, count);
		for (hsize_t k = 0; k < count; k++)
			for (size_t i = 0; i < BODY_COUNT; i++)
				for (int axis = 0; axis < width[c]; axis++, at++) {
					const double wanted = fake_value((uint64_t)steps[k], i, c,
					                                 axis);
					assert_near(*at, wanted, fabs(wanted) * tolerance);
				}
		rb_memory_free(cells);
		/* each element has its steps and times */
		snprintf(path, sizeof path, "/particles/bodies/%s/step", names[c]);
		int64_t *step = read_all(stage, path, RB_H5_I64, &rows);
		assert_int_equal(rows, count);
		assert_memory_equal(step, steps, (size_t)count * sizeof *steps);
		rb_memory_free(step);
		snprintf(path, sizeof path, "/particles/bodies/%s/time", names[c]);
		double *time = read_all(stage, path, RB_H5_F64, &rows);
		for (hsize_t k = 0; k < count; k++)
			assert_true(time[k] == (double)steps[k] / 60);
		rb_memory_free(time);
	}
}

static void frames_come_back_row_by_row(void **state)
{
	struct stage stage;
	int64_t steps[300];
	hsize_t rows;

	(void)state;
	for (int k = 0; k < 300; k++)
		steps[k] = k;
	open_stage(&stage, 300, 1, RB_FIELD_DEFAULT);
	push(&stage, 0, 300);
	finish(&stage);
	check_columns(&stage, steps, 300, 0);
	double *energy = read_all(&stage, "/observables/kinetic_energy/value", RB_H5_F64, &rows);
	double *momentum = read_all(&stage, "/observables/momentum/value", RB_H5_F64, &rows);
	uint64_t *contacts = read_all(&stage, "/observables/contacts/value", RB_H5_U64, &rows);
	assert_int_equal(rows, 300);
	for (uint64_t k = 0; k < 300; k++) {
		assert_true(energy[k] == (double)k);
		assert_true(momentum[3 * k] == 1 && momentum[3 * k + 2] == (double)k);
		assert_int_equal(contacts[k], k % 4);
	}
	rb_memory_free(energy);
	rb_memory_free(momentum);
	rb_memory_free(contacts);
	close_stage(&stage);

	open_stage(&stage, 20, 1, RB_FIELD_POSITION);
	stage.fake.scene.record.single_precision = true;
	rb_frames_release(&stage.frames);
	close_file(&stage.file);
	open_file(&stage.file);
	stage.fake.scene.record.fields = RB_FIELD_DEFAULT;
	rb_frames_create(&stage.file.h5, &stage.frames, &stage.fake.info);
	rb_frames_take_buffers(&stage.file.h5, &stage.frames, 0);
	push(&stage, 0, 20);
	finish(&stage);
	check_columns(&stage, steps, 20, 0x1p-24); /* of half a unit in the last place */
	close_stage(&stage);
}

/* Every n-th frame and the last one; what is counted is counted since the row before. */
static void frames_between_are_added_to_the_next_one(void **state)
{
	static const int64_t steps[] = {0, 4, 8, 12, 13};
	struct stage stage;
	hsize_t rows;

	(void)state;
	open_stage(&stage, 14, 4, RB_FIELD_DEFAULT);
	push(&stage, 0, 14);
	finish(&stage);
	check_columns(&stage, steps, 5, 0);
	uint64_t *collisions = read_all(&stage, "/observables/collisions/value", RB_H5_U64, &rows);
	uint64_t *substeps = read_all(&stage, "/observables/substeps/value", RB_H5_U64, &rows);
	double *energy = read_all(&stage, "/observables/kinetic_energy/value", RB_H5_F64, &rows);
	double *smallest = read_all(&stage, "/observables/smallest_step/value", RB_H5_F64, &rows);
	assert_int_equal(rows, 5);
	for (int row = 0; row < 5; row++) {
		uint64_t count = 0, parts = 0;

		for (int64_t k = row ? steps[row - 1] + 1 : 0; k <= steps[row]; k++) {
			count += (uint64_t)k % 3;
			parts += 4;
		}
		assert_int_equal(collisions[row], count);
		assert_int_equal(substeps[row], parts);
		assert_true(energy[row] == (double)steps[row]); /* a moment's is that frame's */
		assert_true(smallest[row] == 1.0 / (double)(steps[row] + 1));
	}
	rb_memory_free(collisions);
	rb_memory_free(substeps);
	rb_memory_free(energy);
	rb_memory_free(smallest);
	close_stage(&stage);

	/* a run that ends early: its last frame is committed after all */
	static const int64_t short_steps[] = {0, 4, 6};
	open_stage(&stage, 14, 4, RB_FIELD_DEFAULT);
	push(&stage, 0, 7);
	finish(&stage);
	check_columns(&stage, short_steps, 3, 0);
	close_stage(&stage);
}

/* Events are told of all frames, contacts of those that are recorded. */
static void tables_have_as_many_rows_as_their_ends_say(void **state)
{
	struct stage stage;
	hsize_t rows, ends;
	uint64_t events = 0, contacts = 0;

	(void)state;
	open_stage(&stage, 40, 3, RB_FIELD_DEFAULT | RB_FIELD_EVENTS | RB_FIELD_CONTACTS);
	push(&stage, 0, 40);
	finish(&stage);
	uint64_t *event_end = read_all(&stage, "/rbsim/frames/event_end", RB_H5_U64, &ends);
	uint64_t *contact_end = read_all(&stage, "/rbsim/frames/contact_end", RB_H5_U64, &ends);
	int32_t *kind = read_all(&stage, "/rbsim/events/kind", RB_H5_I32, &rows);
	double *impulse = read_all(&stage, "/rbsim/events/impulse", RB_H5_F64, &rows);
	int64_t *step = read_all(&stage, "/rbsim/contacts/step", RB_H5_I64, &rows);
	double *gap = read_all(&stage, "/rbsim/contacts/gap", RB_H5_F64, &rows);
	assert_int_equal(ends, 14);
	uint64_t at_event = 0, at_contact = 0;
	for (uint64_t k = 0; k < 40; k++) {
		events += k % 3;
		contacts += k % 3 == 0 ? k % 4 : 0;
		for (uint64_t i = 0; i < k % 3; i++, at_event++) {
			assert_int_equal(kind[at_event], (k + i) % RB_EVENT_KIND_COUNT);
			assert_true(impulse[3 * at_event + 2] == (double)k);
		}
		for (uint64_t i = 0; k % 3 == 0 && i < k % 4; i++, at_contact++) {
			assert_int_equal(step[at_contact], k);
			assert_true(gap[at_contact] == -1e-9 * (double)i);
		}
		if (k % 3 == 0) {
			assert_int_equal(event_end[k / 3], events);
			assert_int_equal(contact_end[k / 3], contacts);
		}
	}
	assert_int_equal(rows, contacts);
	rb_memory_free(event_end);
	rb_memory_free(contact_end);
	rb_memory_free(kind);
	rb_memory_free(impulse);
	rb_memory_free(step);
	rb_memory_free(gap);
	close_stage(&stage);
}

/* A run that is resumed at frame 9 writes over what its first life wrote behind it. */
static void a_file_that_is_there_is_gone_on_with(void **state)
{
	const unsigned fields = RB_FIELD_DEFAULT | RB_FIELD_EVENTS;
	struct stage stage;
	int64_t steps[20];
	hsize_t rows;

	(void)state;
	for (int k = 0; k < 20; k++)
		steps[k] = k;
	open_stage(&stage, 20, 1, fields);
	push(&stage, 0, 12);
	finish(&stage);
	rb_frames_release(&stage.frames);
	stage.file.h5.there = true;
	rb_frames_create(&stage.file.h5, &stage.frames, &stage.fake.info);
	rb_frames_take_buffers(&stage.file.h5, &stage.frames, 0);
	rb_frames_go_on(&stage.file.h5, &stage.frames, 10, 9);
	assert_int_equal(stage.file.h5.status, RB_OK);
	push(&stage, 10, 20);
	finish(&stage);
	check_columns(&stage, steps, 20, 0);
	uint64_t *end = read_all(&stage, "/rbsim/frames/event_end", RB_H5_U64, &rows);
	uint64_t events = 0;
	for (uint64_t k = 0; k < 20; k++) {
		events += k % 3;
		assert_int_equal(end[k], events);
	}
	rb_memory_free(end);
	/* not so many frames, or another one in that row */
	static const uint64_t wrong[][2] = {{21, 20}, {10, 8}, {10, 10}, {1, 1}};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		rb_frames_release(&stage.frames);
		rb_frames_create(&stage.file.h5, &stage.frames, &stage.fake.info);
		rb_frames_go_on(&stage.file.h5, &stage.frames, wrong[i][0], wrong[i][1]);
		assert_int_equal(stage.file.h5.status, RB_ERR_INPUT);
		assert_non_null(strstr(stage.file.h5.error.text, "does not hold the frames up to"));
		stage.file.h5.status = RB_OK;
	}
	rb_frames_release(&stage.frames);
	/* other columns than those of this run */
	stage.fake.scene.record.single_precision = true;
	rb_frames_create(&stage.file.h5, &stage.frames, &stage.fake.info);
	assert_int_equal(stage.file.h5.status, RB_ERR_INPUT);
	stage.file.h5.status = RB_OK;
	close_stage(&stage);
}

static void a_frame_without_its_columns_is_a_bug_of_ours(void **state)
{
	struct stage stage;
	struct rb_error err;

	(void)state;
	open_stage(&stage, 10, 1, RB_FIELD_DEFAULT);
	struct rb_frame frame = *fake_frame(&stage.fake, 0);
	frame.velocity = NULL;
	assert_int_equal(rb_frames_take(&stage.frames, &frame, &err), RB_ERR_BUG);
	assert_non_null(strstr(err.text, "'/particles/bodies/velocity/value'"));
	frame = *fake_frame(&stage.fake, 0);
	frame.body_count = 4;
	assert_int_equal(rb_frames_take(&stage.frames, &frame, &err), RB_ERR_BUG);
	close_stage(&stage);

	/* what cannot turn has no orientation to be recorded */
	open_file(&stage.file);
	fake_init(&stage.fake, BODY_COUNT, 10, false);
	rb_frames_create(&stage.file.h5, &stage.frames, &stage.fake.info);
	rb_frames_take_buffers(&stage.file.h5, &stage.frames, 0);
	assert_int_equal(stage.frames.fields & RB_FIELD_ORIENTATION, 0);
	push(&stage, 0, 10);
	finish(&stage);
	assert_int_equal(
		H5Lexists(stage.file.h5.file, "/particles/bodies/orientation", H5P_DEFAULT), 0);
	close_stage(&stage);
}

/* How many rows a dataset has. */
static hsize_t rows_of(struct stage *stage, const char *path)
{
	hsize_t rows;

	rb_memory_free(read_all(stage, path, RB_H5_F64, &rows));
	return rows;
}

static void bodies_are_written_before_the_numbers_of_their_frames(void **state)
{
	enum { MANY = 20000, FRAMES = 12 };
	struct stage stage;
	struct rb_error err;
	hsize_t rows;

	(void)state;
	open_file(&stage.file);
	fake_init(&stage.fake, MANY, 100, false);
	stage.fake.scene.record.fields = RB_FIELD_POSITION | RB_FIELD_EVENTS;
	rb_frames_create(&stage.file.h5, &stage.frames, &stage.fake.info);
	rb_frames_take_buffers(&stage.file.h5, &stage.frames, 0);
	hsize_t ahead = 0;
	for (uint64_t k = 0; k < FRAMES; k++) {
		assert_ok(rb_frames_take(&stage.frames, fake_frame(&stage.fake, k), &err));
		assert_false(rb_frames_due(&stage.frames));
		if (!rb_frames_full(&stage.frames))
			continue;
		rb_frames_write_bodies(&stage.file.h5, &stage.frames);
		ahead = k + 1;
	}
	assert_true(ahead > 0);
	assert_int_equal(rows_of(&stage, "/particles/bodies/position/value"), ahead);
	assert_int_equal(rows_of(&stage, "/particles/bodies/position/step"), 0);
	/* where the disk is full: what is written of bodies counts, with the events of those frames */
	rb_frames_write_rest(&stage.file.h5, &stage.frames);
	assert_int_equal(stage.file.h5.status, RB_OK);
	assert_int_equal(rows_of(&stage, "/particles/bodies/position/value"), ahead);
	assert_int_equal(rows_of(&stage, "/particles/bodies/position/step"), ahead);
	uint64_t *ends = read_all(&stage, "/rbsim/frames/event_end", RB_H5_U64, &rows);
	assert_int_equal(rows, ahead);
	assert_int_equal(rows_of(&stage, "/rbsim/events/time"), ends[ahead - 1]);
	rb_memory_free(ends);
	double *cells = read_all(&stage, "/particles/bodies/position/value", RB_H5_F64, &rows);
	assert_true(cells[((ahead - 1) * MANY + 7) * 3 + 2] == fake_value(ahead - 1, 7, 0, 2));
	rb_memory_free(cells);
	close_stage(&stage);
}

/* How much writing takes at most, before it is written; how much in all, before the run. */
static void room_is_known_beforehand(void **state)
{
	struct stage stage;
	struct rb_error err;

	(void)state;
	open_stage(&stage, 2000, 1, RB_FIELD_DEFAULT | RB_FIELD_EVENTS | RB_FIELD_CONTACTS);
	for (uint64_t k = 0; k < 2000; k++) {
		hsize_t before, after;

		assert_ok(rb_frames_take(&stage.frames, fake_frame(&stage.fake, k), &err));
		if (k % 97 != 0 && !rb_frames_full(&stage.frames))
			continue;
		const uint64_t need = rb_frames_need(&stage.frames);
		H5Fflush(stage.file.h5.file, H5F_SCOPE_LOCAL);
		assert_true(H5Fget_filesize(stage.file.h5.file, &before) >= 0);
		rb_frames_write(&stage.file.h5, &stage.frames);
		H5Fflush(stage.file.h5.file, H5F_SCOPE_LOCAL);
		assert_true(H5Fget_filesize(stage.file.h5.file, &after) >= 0);
		assert_int_equal(stage.file.h5.status, RB_OK);
		if (after > before + need)
			fail_msg("frame %d: %d bytes, and %d were said", (int)k,
			         (int)(after - before), (int)need);
	}
	close_stage(&stage);

	/* 13 numbers a body, 15 of the whole, step, time: of 8 bytes */
	open_stage(&stage, 2000, 1, RB_FIELD_DEFAULT);
	const uint64_t plain = rb_frames_plain(&stage.frames, 2000);
	assert_int_equal(plain, (uint64_t)2000 * 8 * (BODY_COUNT * 13 + 15 + 2));
	const uint64_t pretended = rb_frames_pretend(&stage.file.h5, &stage.frames, 2000);
	assert_in_range(pretended, plain, 2 * plain);
	close_stage(&stage);
}

/* Counted one by one: every n-th frame from the first on, and the last. */
static void the_number_of_rows_is_known_beforehand(void **state)
{
	struct fake fake;

	(void)state;
	fake_init(&fake, 1, 1, false);
	for (uint64_t frames = 1; frames < 40; frames++)
		for (int every = 0; every < 45; every++) {
			uint64_t count = 0;

			fake.model.frame_count = frames;
			fake.scene.record.every = every;
			for (uint64_t k = 0; k < frames; k++)
				count += k % (uint64_t)(every > 1 ? every : 1) == 0 ||
				         k + 1 == frames;
			assert_int_equal(rb_frames_expected(&fake.info), count);
		}
	fake_release(&fake);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_come_back_row_by_row),
		cmocka_unit_test(frames_between_are_added_to_the_next_one),
		cmocka_unit_test(tables_have_as_many_rows_as_their_ends_say),
		cmocka_unit_test(a_file_that_is_there_is_gone_on_with),
		cmocka_unit_test(a_frame_without_its_columns_is_a_bug_of_ours),
		cmocka_unit_test(bodies_are_written_before_the_numbers_of_their_frames),
		cmocka_unit_test(room_is_known_beforehand),
		cmocka_unit_test(the_number_of_rows_is_known_beforehand),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
