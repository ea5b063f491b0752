/* SPDX-License-Identifier: MIT */
/*
 * VTK wants [frames * bodies][width], the recording has [frames][bodies][width]. A virtual dataset
 * maps one on the other, since both have the same order of elements; the same row of the source is
 * so seen under two shapes. What VTK needs besides, mostly zeros, is made of datasets that are
 * never written: they read as their fill value.
 */
#include "sink/h5vtk.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

/* Columns that change in time, by the name of VTK. The first is where the points are. */
static const struct {
	const char *name, *source;
	unsigned field;
	int width;
} moving[] = {
	{"/VTKHDF/Points", "/particles/bodies/position/value", RB_FIELD_POSITION, 3},
	{"/VTKHDF/PointData/orientation", "/particles/bodies/orientation/value",
         RB_FIELD_ORIENTATION, 4},
	{"/VTKHDF/PointData/velocity", "/particles/bodies/velocity/value", RB_FIELD_VELOCITY, 3},
	{"/VTKHDF/PointData/angular_velocity", "/particles/bodies/angular_velocity/value",
         RB_FIELD_ANGULAR_VELOCITY, 3},
	{"/VTKHDF/PointData/acceleration", "/particles/bodies/acceleration/value",
         RB_FIELD_ACCELERATION, 3},
	{"/VTKHDF/PointData/angular_acceleration", "/particles/bodies/angular_acceleration/value",
         RB_FIELD_ANGULAR_ACCELERATION, 3},
	{"/VTKHDF/PointData/force", "/particles/bodies/force/value", RB_FIELD_FORCE, 3},
	{"/VTKHDF/PointData/torque", "/particles/bodies/torque/value", RB_FIELD_TORQUE, 3},
};

/* The type of a dataset, to be closed; -1: there is none. */
static hid_t type_of(struct rb_h5 *h5, const char *path)
{
	const hid_t dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);
	const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);

	rb_h5_done(dataset);
	return type;
}

/*
 * Makes a view of a dataset [frames][bodies][width] as [frames * bodies][width]; `row`: bodies,
 * width.
 */
static void put_view(struct rb_h5 *h5, const char *path, const char *source, hsize_t frames,
                     const hsize_t row[2])
{
	if (h5->status)
		return;
	const hid_t type = type_of(h5, source);
	const hid_t flat = H5Screate_simple(2, (const hsize_t[]){frames * row[0], row[1]}, NULL);
	const hid_t whole = H5Screate_simple(3, (const hsize_t[]){frames, row[0], row[1]}, NULL);
	const hid_t links = rb_h5_link_properties();
	const hid_t properties = rb_h5_dataset_properties();
	hid_t dataset = -1;

	if (type >= 0 && H5Pset_virtual(properties, flat, ".", source, whole) >= 0)
		dataset = H5Dcreate2(h5->file, path, type, flat, links, properties, H5P_DEFAULT);
	if (dataset < 0)
		rb_h5_fail(h5, "make", path);
	rb_h5_done(dataset);
	rb_h5_done(properties);
	rb_h5_done(links);
	rb_h5_done(whole);
	rb_h5_done(flat);
	rb_h5_done(type);
}

/* A dataset that is never written: all of it reads as `value` and takes no room. */
static void put_constant(struct rb_h5 *h5, const char *path, rb_h5_shape shape, int64_t value)
{
	if (h5->status)
		return;
	const hid_t space = H5Screate_simple(shape.rank, shape.size, NULL);
	const hid_t links = rb_h5_link_properties();
	const hid_t properties = rb_h5_dataset_properties();
	H5Pset_fill_value(properties, H5T_NATIVE_INT64, &value);
	H5Pset_alloc_time(properties, H5D_ALLOC_TIME_LATE);
	const hid_t dataset = H5Dcreate2(h5->file, path, H5T_STD_I64LE, space, links, properties,
	                                 H5P_DEFAULT);

	if (dataset < 0)
		rb_h5_fail(h5, "make", path);
	rb_h5_done(dataset);
	rb_h5_done(properties);
	rb_h5_done(links);
	rb_h5_done(space);
}

/* value(i) = i * step, for i in [0, count). */
static void put_ramp(struct rb_h5 *h5, const char *path, hsize_t count, int64_t step)
{
	if (h5->status)
		return;
	int64_t *ramp = rb_memory_take(count, sizeof *ramp);
	if (!ramp) {
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY, "cannot write '%s': out of memory",
		                     path);
		return;
	}
	for (hsize_t i = 0; i < count; i++)
		ramp[i] = (int64_t)i * step;
	rb_h5_put(h5, path, RB_H5_I64, (rb_h5_shape){1, {count}}, ramp);
	rb_memory_free(ramp);
}

/*
 * One vertex for each body, the same for all steps; VTK also asks for the other kinds of cells, of
 * which there are none.
 */
static void put_cells(struct rb_h5 *h5, hsize_t bodies)
{
	static const char *const empty[] = {"Lines", "Polygons", "Strips"};
	char path[64];

	put_ramp(h5, "/VTKHDF/Vertices/Connectivity", bodies, 1);
	put_ramp(h5, "/VTKHDF/Vertices/Offsets", bodies + 1, 1);
	put_constant(h5, "/VTKHDF/Vertices/NumberOfCells", (rb_h5_shape){1, {1}}, (int64_t)bodies);
	put_constant(h5, "/VTKHDF/Vertices/NumberOfConnectivityIds", (rb_h5_shape){1, {1}},
	             (int64_t)bodies);
	for (size_t i = 0; i < sizeof empty / sizeof empty[0]; i++) {
		snprintf(path, sizeof path, "/VTKHDF/%s/Connectivity", empty[i]);
		put_constant(h5, path, (rb_h5_shape){1, {0}}, 0);
		snprintf(path, sizeof path, "/VTKHDF/%s/Offsets", empty[i]);
		put_constant(h5, path, (rb_h5_shape){1, {1}}, 0);
		snprintf(path, sizeof path, "/VTKHDF/%s/NumberOfCells", empty[i]);
		put_constant(h5, path, (rb_h5_shape){1, {1}}, 0);
		snprintf(path, sizeof path, "/VTKHDF/%s/NumberOfConnectivityIds", empty[i]);
		put_constant(h5, path, (rb_h5_shape){1, {1}}, 0);
	}
}

/* What does not change in time: every step points to the same rows. */
static void put_fixed(struct rb_h5 *h5, const struct rb_model *model, hsize_t frames)
{
	static const char *const names[] = {"mass", "radius", "id"};
	const hsize_t bodies = (hsize_t)model->body_count;
	char path[64];

	/* soft, so that no header of before is changed */
	rb_h5_link_soft(h5, "/particles/bodies/mass", "/VTKHDF/PointData/mass");
	rb_h5_link_soft(h5, "/particles/bodies/id", "/VTKHDF/PointData/id");
	double *radius = rb_memory_take(bodies, sizeof *radius);
	if (!radius) {
		if (!h5->status)
			h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
			                     "cannot write '/VTKHDF': out of memory");
		return;
	}
	for (hsize_t i = 0; i < bodies; i++)
		radius[i] = rb_model_reach(model, (int)i);
	rb_h5_put(h5, "/VTKHDF/PointData/radius", RB_H5_F64, (rb_h5_shape){1, {bodies}}, radius);
	rb_memory_free(radius);
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		snprintf(path, sizeof path, "/VTKHDF/Steps/PointDataOffsets/%s", names[i]);
		put_constant(h5, path, (rb_h5_shape){1, {frames}}, 0);
	}
}

/* Where the points and values of each step begin. */
static void put_steps(struct rb_h5 *h5, unsigned fields, hsize_t frames, hsize_t bodies)
{
	char path[80];

	put_ramp(h5, "/VTKHDF/Steps/PointOffsets", frames, (int64_t)bodies);
	put_constant(h5, "/VTKHDF/Steps/PartOffsets", (rb_h5_shape){1, {frames}}, 0);
	put_constant(h5, "/VTKHDF/Steps/NumberOfParts", (rb_h5_shape){1, {frames}}, 1);
	put_constant(h5, "/VTKHDF/Steps/CellOffsets", (rb_h5_shape){2, {frames, 4}}, 0);
	put_constant(h5, "/VTKHDF/Steps/ConnectivityIdOffsets", (rb_h5_shape){2, {frames, 4}}, 0);
	for (size_t i = 1; i < sizeof moving / sizeof moving[0]; i++) {
		if (!(fields & moving[i].field))
			continue;
		snprintf(path, sizeof path, "/VTKHDF/Steps/PointDataOffsets/%s",
		         strrchr(moving[i].name, '/') + 1);
		rb_h5_link(h5, "/VTKHDF/Steps/PointOffsets", path);
	}
}

uint64_t rb_vtk_need(const struct rb_model *model, uint64_t frames)
{
	/* 64 KiB of headers; a ramp over the frames, and for each body two ramps and a radius */
	return 65536 + 8 * frames + 24 * (uint64_t)model->body_count;
}

void rb_vtk_write(struct rb_h5 *h5, const struct rb_model *model, unsigned fields, uint64_t frames,
                  const char *time)
{
	const hsize_t bodies = (hsize_t)model->body_count;

	if (!(fields & RB_FIELD_POSITION) || bodies == 0 || frames == 0 || h5->status)
		return;
	rb_h5_group(h5, "/VTKHDF");
	rb_h5_attribute(h5, "/VTKHDF", "Version", RB_H5_I64, 2, (const int64_t[]){2, 0});
	rb_h5_attribute_text(h5, "/VTKHDF", "Type", "PolyData");
	put_constant(h5, "/VTKHDF/NumberOfPoints", (rb_h5_shape){1, {1}}, (int64_t)bodies);
	for (size_t i = 0; i < sizeof moving / sizeof moving[0]; i++)
		if (fields & moving[i].field)
			put_view(h5, moving[i].name, moving[i].source, frames,
			         (hsize_t[]){bodies, (hsize_t)moving[i].width});
	put_cells(h5, bodies);
	rb_h5_group(h5, "/VTKHDF/Steps");
	rb_h5_attribute(h5, "/VTKHDF/Steps", "NSteps", RB_H5_I64, 0, &(int64_t){(int64_t)frames});
	rb_h5_link(h5, time, "/VTKHDF/Steps/Values");
	put_steps(h5, fields, frames, bodies);
	put_fixed(h5, model, frames);
}
