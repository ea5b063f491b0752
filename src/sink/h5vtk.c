/* SPDX-License-Identifier: MIT */
/*
 * VTK wants [frames * bodies][width], the recording has [frames][bodies][width]. A virtual dataset
 * maps one on the other, since both have the same order of elements; the same row of the source is
 * so seen under two shapes. What VTK needs besides, mostly zeros, is made of datasets that are
 * never written: they read as their fill value.
 */
#include "sink/h5vtk.h"

#include "base/error.h"
#include "base/memory.h"
#include "sink/h5polydata.h"

#include <stdio.h>
#include <string.h>

enum { PARTS_MAX = 4 };

/* Columns that change in time, by the name of VTK. The first is where the points are. */
static const struct {
	const char *name, *source;
	unsigned field;
	int width;
} moving[] = {
	{"Points", "/particles/bodies/position/value", RB_FIELD_POSITION, 3},
	{"PointData/orientation", "/particles/bodies/orientation/value", RB_FIELD_ORIENTATION, 4},
	{"PointData/velocity", "/particles/bodies/velocity/value", RB_FIELD_VELOCITY, 3},
	{"PointData/angular_velocity", "/particles/bodies/angular_velocity/value",
         RB_FIELD_ANGULAR_VELOCITY, 3},
	{"PointData/acceleration", "/particles/bodies/acceleration/value", RB_FIELD_ACCELERATION,
         3},
	{"PointData/angular_acceleration", "/particles/bodies/angular_acceleration/value",
         RB_FIELD_ANGULAR_ACCELERATION, 3},
	{"PointData/force", "/particles/bodies/force/value", RB_FIELD_FORCE, 3},
	{"PointData/torque", "/particles/bodies/torque/value", RB_FIELD_TORQUE, 3},
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

/* A vertex for each body, the same for all steps, and what of it does not change in time. */
static void put_bodies(struct rb_h5 *h5, const struct rb_polydata *data,
                       const struct rb_model *model)
{
	const hsize_t bodies = (hsize_t)model->body_count;

	rb_polydata_count(h5, data, bodies, bodies, bodies);
	rb_polydata_ramp(h5, data, "Vertices/Connectivity", bodies, 1);
	rb_polydata_ramp(h5, data, "Vertices/Offsets", bodies + 1, 1);
	rb_polydata_link(h5, data, "PointData/mass", "/particles/bodies/mass");
	rb_polydata_link(h5, data, "PointData/id", "/particles/bodies/id");
	double *radius = rb_memory_take(bodies, sizeof *radius);
	if (!radius) {
		if (!h5->status)
			h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
			                     "cannot write '/VTKHDF': out of memory");
		return;
	}
	for (hsize_t i = 0; i < bodies; i++)
		radius[i] = rb_model_reach(model, (int)i);
	rb_polydata_put(h5, data, "PointData/radius", RB_H5_F64, (rb_h5_shape){1, {bodies}},
	                radius);
	rb_memory_free(radius);
	rb_polydata_fixed(h5, data, "PointData", "mass");
	rb_polydata_fixed(h5, data, "PointData", "radius");
	rb_polydata_fixed(h5, data, "PointData", "id");
}

/* The bodies as points, which move. */
static void write_bodies(struct rb_h5 *h5, const struct rb_vtk *vtk, const char *base, int index)
{
	const hsize_t bodies = (hsize_t)vtk->model->body_count;
	const struct rb_polydata data = {base, vtk->time, "Vertices", vtk->frames};
	char path[RB_POLYDATA_PATH_SIZE];

	rb_polydata_begin(h5, &data, index, false);
	for (size_t i = 0; i < sizeof moving / sizeof moving[0]; i++)
		if (vtk->fields & moving[i].field)
			put_view(h5, rb_polydata_path(&data, moving[i].name, path),
			         moving[i].source, vtk->frames,
			         (hsize_t[]){bodies, (hsize_t)moving[i].width});
	put_bodies(h5, &data, vtk->model);
	rb_polydata_ramp(h5, &data, "Steps/PointOffsets", vtk->frames, (int64_t)bodies);
	for (size_t i = 1; i < sizeof moving / sizeof moving[0]; i++)
		if (vtk->fields & moving[i].field)
			rb_polydata_moving(h5, &data, strrchr(moving[i].name, '/') + 1);
}

/* ---- contacts ---- */

/* The ends of the rows of each frame; NULL: a failure. To be freed. */
static int64_t *read_ends(struct rb_h5 *h5, hsize_t frames)
{
	static const char path[] = "/rbsim/frames/contact_end";
	int64_t *const ends = rb_memory_take(frames, sizeof *ends);

	if (!ends) {
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
		                     "cannot write '/VTKHDF': out of memory");
		return NULL;
	}
	const hid_t dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);
	const hid_t space = dataset < 0 ? -1 : H5Dget_space(dataset);
	const hid_t memory = H5Screate_simple(1, &frames, NULL);
	if (space < 0 ||
	    H5Sselect_hyperslab(space, H5S_SELECT_SET, (const hsize_t[]){0}, NULL, &frames, NULL) <
	            0 ||
	    H5Dread(dataset, H5T_NATIVE_INT64, memory, space, H5P_DEFAULT, ends) < 0)
		rb_h5_fail(h5, "read", path);
	rb_h5_done(memory);
	rb_h5_done(space);
	rb_h5_done(dataset);
	return ends;
}

/* Each contact is a vertex at its point: the table of contacts itself, from where a frame begins.
 * `rows`: the ends of frames, of which it makes their numbers of rows. */
static void write_contacts(struct rb_h5 *h5, const struct rb_vtk *vtk, int index, int64_t *rows)
{
	static const char *const columns[] = {"force", "normal", "gap", "a", "b"};
	const struct rb_polydata data = {"/VTKHDF/contacts", vtk->time, "Vertices", vtk->frames};
	const rb_h5_shape per_frame = {1, {vtk->frames}};
	int64_t most = 0, before = 0;
	char name[48];

	int64_t *const first = rb_memory_take(vtk->frames, sizeof *first);

	if (!first) {
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
		                     "cannot write '/VTKHDF': out of memory");
		return;
	}
	for (uint64_t k = 0; k < vtk->frames; k++) {
		first[k] = before;
		before = rows[k];
		rows[k] -= first[k];
		most = rows[k] > most ? rows[k] : most;
	}
	rb_polydata_begin(h5, &data, index, true);
	rb_polydata_link(h5, &data, "Points", "/rbsim/contacts/point");
	/* what the rows of these columns are called, to be found above them (h5scales.h) */
	rb_polydata_link(h5, &data, "step", "/rbsim/contacts/step");
	rb_polydata_put(h5, &data, "NumberOfPoints", RB_H5_I64, per_frame, rows);
	rb_polydata_put(h5, &data, "Vertices/NumberOfCells", RB_H5_I64, per_frame, rows);
	rb_polydata_put(h5, &data, "Vertices/NumberOfConnectivityIds", RB_H5_I64, per_frame, rows);
	rb_polydata_ramp(h5, &data, "Vertices/Connectivity", (hsize_t)most, 1);
	rb_polydata_ramp(h5, &data, "Vertices/Offsets", (hsize_t)most + 1, 1);
	rb_polydata_put(h5, &data, "Steps/PointOffsets", RB_H5_I64, per_frame, first);
	for (size_t k = 0; k < sizeof columns / sizeof columns[0]; k++) {
		char path[48];

		snprintf(name, sizeof name, "PointData/%s", columns[k]);
		snprintf(path, sizeof path, "/rbsim/contacts/%s", columns[k]);
		rb_polydata_link(h5, &data, name, path);
		rb_polydata_moving(h5, &data, columns[k]);
	}
	rb_memory_free(first);
}

/* ---- the group ---- */

struct rb_vtk rb_vtk_of(const struct rb_run_info *info, const struct rb_frames *frames,
                        uint64_t rows)
{
	return (struct rb_vtk){.model = info->model,
	                       .time = frames->time->path,
	                       .fields = frames->fields & ~(unsigned)RB_FIELD_SURFACES,
	                       .frames = rows};
}

enum rb_status rb_vtk_begin(struct rb_vtk *vtk, struct rb_error *err)
{
	return vtk->fields & RB_FIELD_SURFACES ? rb_surfaces_make(&vtk->surfaces, vtk->model, err)
	                                       : RB_OK;
}

void rb_vtk_release(struct rb_vtk *vtk)
{
	rb_surfaces_release(&vtk->surfaces);
}

uint64_t rb_vtk_need(const struct rb_vtk *vtk)
{
	/*
	 * 64 KiB of headers; a ramp over the frames, and for each body two ramps and a radius; of
	 * contacts five numbers a frame, and no more ramps than a frame has rows
	 */
	uint64_t need = 65536 + 8 * vtk->frames + 24 * (uint64_t)vtk->model->body_count;

	if (vtk->fields & RB_FIELD_CONTACTS)
		need += 65536 + 40 * vtk->frames;
	if (vtk->fields & RB_FIELD_SURFACES)
		need += 65536 + rb_surfaces_bytes(&vtk->surfaces, vtk->frames);
	return need;
}

/* Lists the parts of the collection in their order. */
static void put_assembly(struct rb_h5 *h5, const char *const names[], int count)
{
	char path[64], to[64];

	rb_h5_attribute(h5, "/VTKHDF", "Version", RB_H5_I64, 2, (const int64_t[]){2, 1});
	rb_h5_attribute_text(h5, "/VTKHDF", "Type", "PartitionedDataSetCollection");
	rb_h5_group_ordered(h5, "/VTKHDF/Assembly");
	for (int k = 0; k < count; k++) {
		snprintf(path, sizeof path, "/VTKHDF/Assembly/%s", names[k]);
		snprintf(to, sizeof to, "/VTKHDF/%s", names[k]);
		rb_h5_link_soft(h5, to, path);
	}
}

void rb_vtk_write(struct rb_h5 *h5, struct rb_vtk *vtk)
{
	const struct rb_surfaces_frames frames = {vtk->fields, vtk->frames, vtk->time,
	                                          vtk->pretend};
	const char *names[PARTS_MAX] = {"bodies"};
	int count = 1;

	if (!(vtk->fields & RB_FIELD_POSITION) || vtk->model->body_count == 0 || vtk->frames == 0 ||
	    h5->status)
		return;
	int64_t *const ends = vtk->fields & RB_FIELD_CONTACTS ? read_ends(h5, vtk->frames) : NULL;
	const bool contacts = ends && (ends[vtk->frames - 1] > 0 || vtk->pretend);
	if (!contacts && !vtk->surfaces.model) {
		write_bodies(h5, vtk, "/VTKHDF", -1);
		rb_memory_free(ends);
		return;
	}
	rb_h5_group_ordered(h5, "/VTKHDF");
	write_bodies(h5, vtk, "/VTKHDF/bodies", 0);
	if (vtk->surfaces.moving.triangle_count > 0)
		names[count++] = "surfaces";
	if (vtk->surfaces.fixed.triangle_count > 0)
		names[count++] = "statics";
	if (vtk->surfaces.model)
		rb_surfaces_write(h5, &vtk->surfaces, &frames, 1);
	if (contacts && !h5->status) {
		write_contacts(h5, vtk, count, ends);
		names[count++] = "contacts";
	}
	rb_memory_free(ends);
	put_assembly(h5, names, count);
}
