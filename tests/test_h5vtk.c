/* SPDX-License-Identifier: MIT */
/* src/sink/h5vtk.c: a recording as VTK's readers want it, read as these would */
#include "h5place.h"
#include "h5support.h"

#include "sink/h5vtk.h"

enum { STEPS = 4, COUNT = 3 };
static const unsigned all_fields = RB_FIELD_DEFAULT | RB_FIELD_LOADS;

/* Columns of a recording by the formula of fake_value; `fields` of them. */
static void put_columns(struct rb_h5 *h5, unsigned fields)
{
	static const struct {
		const char *name;
		hsize_t width;
	} columns[] = {{"position", 3},     {"orientation", 4},
	               {"velocity", 3},     {"angular_velocity", 3},
	               {"acceleration", 3}, {"angular_acceleration", 3},
	               {"force", 3},        {"torque", 3}};
	static const unsigned bits[] = {RB_FIELD_POSITION,     RB_FIELD_ORIENTATION,
	                                RB_FIELD_VELOCITY,     RB_FIELD_ANGULAR_VELOCITY,
	                                RB_FIELD_ACCELERATION, RB_FIELD_ANGULAR_ACCELERATION,
	                                RB_FIELD_FORCE,        RB_FIELD_TORQUE};
	double cells[STEPS * COUNT * 4], times[STEPS];
	char path[80];

	for (int c = 0; c < 8; c++) {
		const int width = (int)columns[c].width;

		if (!(fields & bits[c]))
			continue;
		for (int k = 0; k < STEPS * COUNT; k++)
			for (int axis = 0; axis < width; axis++)
				cells[k * width + axis] = fake_value((uint64_t)(k / COUNT),
				                                     (size_t)(k % COUNT), c, axis);
		snprintf(path, sizeof path, "/particles/bodies/%s/value", columns[c].name);
		rb_h5_put(h5, path, RB_H5_F64, (rb_h5_shape){3, {STEPS, COUNT, (hsize_t)width}},
		          cells);
	}
	for (int k = 0; k < STEPS; k++)
		times[k] = k / 60.0;
	rb_h5_put(h5, "/particles/bodies/position/time", RB_H5_F64, (rb_h5_shape){1, {STEPS}},
	          times);
	rb_h5_put(h5, "/particles/bodies/mass", RB_H5_F64, (rb_h5_shape){1, {COUNT}}, cells);
	rb_h5_put(h5, "/particles/bodies/id", RB_H5_I64, (rb_h5_shape){1, {COUNT}},
	          (const int64_t[COUNT]){4, 5, 6});
}

/* Of the fake's bodies, with no surfaces. */
static struct rb_vtk view_of(const struct fake *fake, unsigned fields, uint64_t frames)
{
	return (struct rb_vtk){.model = &fake->model,
	                       .time = "/particles/bodies/position/time",
	                       .fields = fields,
	                       .frames = frames};
}

static void write_view(struct file *file, const struct fake *fake, unsigned fields, uint64_t frames)
{
	struct rb_vtk vtk = view_of(fake, fields, frames);

	rb_vtk_write(&file->h5, &vtk);
}

static void write_all(struct file *file, struct fake *fake, unsigned fields, uint64_t frames)
{
	put_columns(&file->h5, fields);
	write_view(file, fake, fields, frames);
}

/* How many numbers there are at `path`, and the numbers as `kind`. */
static int read_all(struct file *file, const char *path, enum rb_h5_kind kind, void *out, int most)
{
	const hid_t dataset = H5Dopen2(file->h5.file, path, H5P_DEFAULT);
	const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);

	if (space < 0)
		fail_msg("no '%s'", path);
	const int count = (int)H5Sget_simple_extent_npoints(space);
	if (count > most)
		fail_msg("'%s' has %d numbers", path, count);
	assert_true(H5Dread(dataset, rb_h5_type(kind), H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0);
	rb_h5_done(space);
	rb_h5_done(dataset);
	return count;
}

/* Point i of step k is row PointOffsets[k] + i. */
static void columns_are_seen_step_by_step(void **state)
{
	static const char *const names[] = {"/VTKHDF/Points",
	                                    "/VTKHDF/PointData/orientation",
	                                    "/VTKHDF/PointData/velocity",
	                                    "/VTKHDF/PointData/angular_velocity",
	                                    "/VTKHDF/PointData/acceleration",
	                                    "/VTKHDF/PointData/angular_acceleration",
	                                    "/VTKHDF/PointData/force",
	                                    "/VTKHDF/PointData/torque"};
	struct file file;
	struct fake fake;
	double cells[STEPS * COUNT * 4];
	int64_t offset[STEPS];

	(void)state;
	open_file(&file);
	fake_init(&fake, COUNT, STEPS, true);
	write_all(&file, &fake, all_fields, STEPS);
	turn_file(&file, H5F_ACC_RDONLY);
	assert_int_equal(read_all(&file, "/VTKHDF/Steps/PointOffsets", RB_H5_I64, offset, STEPS),
	                 STEPS);
	for (int c = 0; c < 8; c++) {
		const int width = c == 1 ? 4 : 3;

		assert_int_equal(read_all(&file, names[c], RB_H5_F64, cells, STEPS * COUNT * 4),
		                 STEPS * COUNT * width);
		for (uint64_t k = 0; k < STEPS; k++)
			for (size_t i = 0; i < COUNT; i++)
				for (int axis = 0; axis < width; axis++)
					assert_true(cells[((size_t)offset[k] + i) * (size_t)width +
					                  (size_t)axis] ==
					            fake_value(k, i, c, axis));
	}
	fake_release(&fake);
	close_file(&file);
}

static int64_t number_at(struct file *file, const char *path, int place, int count)
{
	int64_t numbers[64] = {0};

	if (read_all(file, path, RB_H5_I64, numbers, 64) != count)
		fail_msg("'%s' has not %d numbers", path, count);
	return numbers[place];
}

/* As the VTKHDF format has it for PolyData: one vertex a point, no lines, polygons and strips. */
static void every_body_is_a_vertex(void **state)
{
	static const char *const empty[] = {"Lines", "Polygons", "Strips"};
	struct file file;
	struct fake fake;
	char path[80];

	(void)state;
	open_file(&file);
	fake_init(&fake, COUNT, STEPS, true);
	write_all(&file, &fake, RB_FIELD_POSITION, STEPS);
	turn_file(&file, H5F_ACC_RDONLY);
	assert_int_equal(number_at(&file, "/VTKHDF/NumberOfPoints", 0, 1), COUNT);
	assert_int_equal(number_at(&file, "/VTKHDF/Vertices/NumberOfCells", 0, 1), COUNT);
	assert_int_equal(number_at(&file, "/VTKHDF/Vertices/NumberOfConnectivityIds", 0, 1), COUNT);
	for (int i = 0; i < COUNT; i++)
		assert_int_equal(number_at(&file, "/VTKHDF/Vertices/Connectivity", i, COUNT), i);
	for (int i = 0; i <= COUNT; i++)
		assert_int_equal(number_at(&file, "/VTKHDF/Vertices/Offsets", i, COUNT + 1), i);
	for (int k = 0; k < 3; k++) {
		snprintf(path, sizeof path, "/VTKHDF/%s/NumberOfCells", empty[k]);
		assert_int_equal(number_at(&file, path, 0, 1), 0);
		snprintf(path, sizeof path, "/VTKHDF/%s/NumberOfConnectivityIds", empty[k]);
		assert_int_equal(number_at(&file, path, 0, 1), 0);
		snprintf(path, sizeof path, "/VTKHDF/%s/Offsets", empty[k]);
		assert_int_equal(number_at(&file, path, 0, 1), 0);
		snprintf(path, sizeof path, "/VTKHDF/%s/Connectivity", empty[k]);
		assert_int_equal(number_at(&file, path, 0, 0), 0);
	}
	for (int k = 0; k < STEPS; k++) {
		assert_int_equal(number_at(&file, "/VTKHDF/Steps/PartOffsets", k, STEPS), 0);
		assert_int_equal(number_at(&file, "/VTKHDF/Steps/NumberOfParts", k, STEPS), 1);
		for (int cell = 0; cell < 4; cell++)
			assert_int_equal(number_at(&file, "/VTKHDF/Steps/CellOffsets", 4 * k + cell,
			                           4 * STEPS),
			                 0);
	}
	fake_release(&fake);
	close_file(&file);
}

static void what_does_not_change_stands_there_once(void **state)
{
	struct file file;
	struct fake fake;
	double radius[COUNT], times[STEPS];

	(void)state;
	open_file(&file);
	fake_init(&fake, COUNT, STEPS, true);
	write_all(&file, &fake, RB_FIELD_DEFAULT, STEPS);
	turn_file(&file, H5F_ACC_RDONLY);
	for (int i = 0; i < COUNT; i++)
		assert_int_equal(number_at(&file, "/VTKHDF/PointData/id", i, COUNT), 4 + i);
	assert_int_equal(read_all(&file, "/VTKHDF/PointData/radius", RB_H5_F64, radius, COUNT),
	                 COUNT);
	for (int i = 0; i < COUNT; i++)
		assert_true(radius[i] == 0.5); /* of the fake's balls */
	for (int k = 0; k < STEPS; k++) {
		assert_int_equal(number_at(&file, "/VTKHDF/Steps/PointDataOffsets/mass", k, STEPS),
		                 0);
		assert_int_equal(
			number_at(&file, "/VTKHDF/Steps/PointDataOffsets/radius", k, STEPS), 0);
		assert_int_equal(
			number_at(&file, "/VTKHDF/Steps/PointDataOffsets/velocity", k, STEPS),
			COUNT * k);
	}
	assert_int_equal(read_all(&file, "/VTKHDF/Steps/Values", RB_H5_F64, times, STEPS), STEPS);
	assert_true(times[3] == 3 / 60.0);
	fake_release(&fake);
	close_file(&file);
}

static void attributes_name_the_format(void **state)
{
	struct file file;
	struct fake fake;
	int64_t version[2] = {0}, steps = 0;
	char type_name[20] = "";

	(void)state;
	open_file(&file);
	fake_init(&fake, COUNT, STEPS, true);
	write_all(&file, &fake, RB_FIELD_POSITION, STEPS);
	turn_file(&file, H5F_ACC_RDONLY);
	hid_t attribute = H5Aopen_by_name(file.h5.file, "/VTKHDF", "Version", H5P_DEFAULT,
	                                  H5P_DEFAULT);
	assert_true(H5Aread(attribute, H5T_NATIVE_INT64, version) >= 0);
	assert_true(version[0] == 2 && version[1] == 0);
	rb_h5_done(attribute);
	attribute = H5Aopen_by_name(file.h5.file, "/VTKHDF/Steps", "NSteps", H5P_DEFAULT,
	                            H5P_DEFAULT);
	assert_true(H5Aread(attribute, H5T_NATIVE_INT64, &steps) >= 0);
	assert_int_equal(steps, STEPS);
	rb_h5_done(attribute);
	attribute = H5Aopen_by_name(file.h5.file, "/VTKHDF", "Type", H5P_DEFAULT, H5P_DEFAULT);
	const hid_t type = H5Aget_type(attribute);
	assert_int_equal(H5Tget_cset(type), H5T_CSET_ASCII); /* VTK reads no other */
	assert_true(H5Aread(attribute, type, type_name) >= 0);
	assert_string_equal(type_name, "PolyData");
	rb_h5_done(type);
	rb_h5_done(attribute);
	fake_release(&fake);
	close_file(&file);
}

static void there_is_none_without_positions_bodies_or_frames(void **state)
{
	struct file file;
	struct fake fake;

	(void)state;
	open_file(&file);
	fake_init(&fake, COUNT, STEPS, true);
	write_all(&file, &fake, RB_FIELD_VELOCITY, STEPS);
	write_view(&file, &fake, RB_FIELD_POSITION, 0);
	fake.model.body_count = 0;
	write_view(&file, &fake, RB_FIELD_POSITION, STEPS);
	assert_int_equal(file.h5.status, RB_OK);
	assert_int_equal(H5Lexists(file.h5.file, "/VTKHDF", H5P_DEFAULT), 0);
	fake.model.body_count = COUNT;
	/* no column to look at: it is told */
	write_view(&file, &fake, RB_FIELD_POSITION, STEPS);
	assert_int_equal(file.h5.status, RB_ERR_IO);
	file.h5.status = RB_OK;
	fake_release(&fake);
	close_file(&file);
}

/* Not a number of the columns is copied: many frames take as much as few, but for their ramp. */
static void it_takes_no_more_room_than_was_said(void **state)
{
	static const uint64_t frames[] = {1, 4, 5000};

	(void)state;
	for (int k = 0; k < 3; k++) {
		struct file file;
		struct fake fake;
		hsize_t before, after;

		open_file(&file);
		fake_init(&fake, COUNT, STEPS, true);
		put_columns(&file.h5, all_fields);
		H5Fflush(file.h5.file, H5F_SCOPE_LOCAL);
		assert_true(H5Fget_filesize(file.h5.file, &before) >= 0);
		write_view(&file, &fake, all_fields, frames[k]);
		H5Fflush(file.h5.file, H5F_SCOPE_LOCAL);
		assert_true(H5Fget_filesize(file.h5.file, &after) >= 0);
		assert_int_equal(file.h5.status, RB_OK);
		const struct rb_vtk vtk = view_of(&fake, all_fields, frames[k]);
		assert_true(after - before <= rb_vtk_need(&vtk));
		assert_true(rb_vtk_need(&vtk) < 8 * frames[k] + 100000);
		fake_release(&fake);
		close_file(&file);
	}
}

/* Of balls: every point of step k is a radius away from where its ball is then. */
static void surfaces_move_with_their_bodies(void **state)
{
	static float points[STEPS * COUNT * 400 * 3];
	static int64_t corners[COUNT * 2000];
	struct file file;
	struct fake fake;

	(void)state;
	open_file(&file);
	fake_init(&fake, COUNT, STEPS, true);
	put_columns(&file.h5, RB_FIELD_POSITION);
	struct rb_vtk vtk = view_of(&fake, RB_FIELD_POSITION | RB_FIELD_SURFACES, STEPS);
	assert_int_equal(rb_vtk_begin(&vtk, NULL), RB_OK);
	rb_vtk_write(&file.h5, &vtk);
	rb_vtk_release(&vtk);
	turn_file(&file, H5F_ACC_RDONLY);

	const int64_t all = number_at(&file, "/VTKHDF/surfaces/NumberOfPoints", 0, 1);
	const int each = (int)all / COUNT;
	/* 24 sides, 11 circles between poles; a corner that faces share is one point */
	assert_int_equal(each, 24 * 11 + 2);
	assert_int_equal(read_all(&file, "/VTKHDF/surfaces/Points", RB_H5_F32, points,
	                          (int)(sizeof points / sizeof *points)),
	                 STEPS * all * 3);
	for (int k = 0; k < STEPS; k++)
		for (int i = 0; i < all; i++) {
			double square = 0;
			for (int axis = 0; axis < 3; axis++) {
				const double at = fake_value((uint64_t)k, (size_t)(i / each), 0,
				                             axis);
				const double d = (double)points[3 * (k * all + i) + axis] - at;
				square += d * d;
			}
			/* 2^13 m in 24 bits: half a millimetre at most, on each axis */
			assert_near(square, 0.25, 2 * 0.5 * 3 * 4.9e-4);
		}
	const int count = read_all(&file, "/VTKHDF/surfaces/Polygons/Connectivity", RB_H5_I64,
	                           corners, (int)(sizeof corners / sizeof *corners));
	assert_int_equal(
		number_at(&file, "/VTKHDF/surfaces/Polygons/NumberOfConnectivityIds", 0, 1), count);
	for (int i = 0; i < count; i++)
		assert_true(corners[i] / each == corners[i / 3 * 3] / each); /* of one ball */
	/* the plane stands there once */
	const int64_t still = number_at(&file, "/VTKHDF/statics/NumberOfPoints", 0, 1);
	assert_int_equal(
		read_all(&file, "/VTKHDF/statics/Points", RB_H5_F32, points, 3 * (int)still),
		3 * still);
	fake_release(&fake);
	close_file(&file);
}

static void memory_that_is_out_is_told(void **state)
{
	struct file file;
	struct fake fake;
	bool whole = false;

	(void)state;
	fake_init(&fake, COUNT, STEPS, true);
	for (uint64_t k = 1; !whole; k++) {
		struct rb_error error;
		assert_true(k < 200);
		open_file(&file);
		put_columns(&file.h5, RB_FIELD_DEFAULT);
		struct rb_vtk vtk = view_of(&fake, RB_FIELD_DEFAULT | RB_FIELD_SURFACES, STEPS);
		rb_memory_fail_at(k);
		const enum rb_status status = rb_vtk_begin(&vtk, &error);
		if (!status)
			rb_vtk_write(&file.h5, &vtk);
		rb_memory_fail_at(0);
		rb_vtk_release(&vtk);
		whole = status == RB_OK && file.h5.status == RB_OK;
		assert_true(whole || status == RB_ERR_MEMORY || file.h5.status == RB_ERR_MEMORY);
		file.h5.status = RB_OK;
		close_file(&file);
	}
	fake_release(&fake);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(columns_are_seen_step_by_step),
		cmocka_unit_test(every_body_is_a_vertex),
		cmocka_unit_test(what_does_not_change_stands_there_once),
		cmocka_unit_test(attributes_name_the_format),
		cmocka_unit_test(there_is_none_without_positions_bodies_or_frames),
		cmocka_unit_test(it_takes_no_more_room_than_was_said),
		cmocka_unit_test(surfaces_move_with_their_bodies),
		cmocka_unit_test(memory_that_is_out_is_told),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
