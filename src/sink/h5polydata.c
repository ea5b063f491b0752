/* SPDX-License-Identifier: MIT */
#include "sink/h5polydata.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

/* All kinds of cells that VTK asks for. */
static const char *const kinds[] = {"Vertices", "Lines", "Polygons", "Strips"};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

const char *rb_polydata_path(const struct rb_polydata *data, const char *name,
                             char out[RB_POLYDATA_PATH_SIZE])
{
	const int size = snprintf(out, RB_POLYDATA_PATH_SIZE, "%s/%s", data->base, name);

	RB_ASSERT(size > 0 && size < RB_POLYDATA_PATH_SIZE);
	return out;
}

void rb_polydata_constant(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                          rb_h5_shape shape, int64_t value)
{
	char path[RB_POLYDATA_PATH_SIZE];

	if (h5->status)
		return;
	rb_polydata_path(data, name, path);
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

void rb_polydata_put(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                     enum rb_h5_kind kind, rb_h5_shape shape, const void *numbers)
{
	char path[RB_POLYDATA_PATH_SIZE];

	rb_h5_put(h5, rb_polydata_path(data, name, path), kind, shape, numbers);
}

void rb_polydata_link(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                      const char *to)
{
	char path[RB_POLYDATA_PATH_SIZE];

	rb_h5_link_soft(h5, to, rb_polydata_path(data, name, path));
}

void rb_polydata_ramp(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                      hsize_t count, int64_t step)
{
	if (h5->status)
		return;
	int64_t *ramp = rb_memory_take(count + 1, sizeof *ramp);
	if (!ramp) {
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
		                     "cannot write '%s/%s': out of memory", data->base, name);
		return;
	}
	for (hsize_t i = 0; i < count; i++)
		ramp[i] = (int64_t)i * step;
	rb_polydata_put(h5, data, name, RB_H5_I64, (rb_h5_shape){1, {count}}, ramp);
	rb_memory_free(ramp);
}

/* Another name for a dataset below `base`. */
static void share(struct rb_h5 *h5, const struct rb_polydata *data, const char *name,
                  const char *new_name)
{
	char from[RB_POLYDATA_PATH_SIZE], to[RB_POLYDATA_PATH_SIZE];

	rb_h5_link(h5, rb_polydata_path(data, name, from), rb_polydata_path(data, new_name, to));
}

/* The kinds of cells of which there are none: all have the same two or three datasets. */
static void put_no_cells(struct rb_h5 *h5, const struct rb_polydata *data, bool varies)
{
	static const char *const members[] = {"Connectivity", "Offsets", "NumberOfCells",
	                                      "NumberOfConnectivityIds"};
	char first[4][48] = {""}, name[48];

	for (int k = 0; k < KIND_COUNT; k++)
		for (int m = 0; m < 4 && strcmp(kinds[k], data->cells) != 0; m++) {
			const bool counts = m >= 2 && varies;
			const int as = m == 0 ? 0 : counts ? 2 : 1;

			snprintf(name, sizeof name, "%s/%s", kinds[k], members[m]);
			if (*first[as]) {
				share(h5, data, first[as], name);
				continue;
			}
			snprintf(first[as], sizeof first[as], "%s", name);
			rb_polydata_constant(h5, data, name,
			                     (rb_h5_shape){1,
			                                   {m == 0   ? 0
			                                    : counts ? data->steps
			                                             : 1}},
			                     0);
		}
}

void rb_polydata_begin(struct rb_h5 *h5, const struct rb_polydata *data, int index, bool varies)
{
	char path[RB_POLYDATA_PATH_SIZE];

	rb_h5_group(h5, data->base);
	rb_h5_attribute(h5, data->base, "Version", RB_H5_I64, 2, (const int64_t[]){2, 0});
	rb_h5_attribute_text(h5, data->base, "Type", "PolyData");
	if (index >= 0)
		rb_h5_attribute(h5, data->base, "Index", RB_H5_I64, 0, &(int64_t){index});
	put_no_cells(h5, data, varies);
	rb_h5_group(h5, rb_polydata_path(data, "Steps", path));
	rb_h5_attribute(h5, path, "NSteps", RB_H5_I64, 0, &(int64_t){(int64_t)data->steps});
	/* soft: programs that ask what the times are called are told their first hard link */
	rb_polydata_link(h5, data, "Steps/Values", data->time);
	if (varies)
		rb_polydata_ramp(h5, data, "Steps/PartOffsets", data->steps, 1);
	else
		rb_polydata_constant(h5, data, "Steps/PartOffsets", (rb_h5_shape){1, {data->steps}},
		                     0);
	rb_polydata_constant(h5, data, "Steps/NumberOfParts", (rb_h5_shape){1, {data->steps}}, 1);
	rb_polydata_constant(h5, data, "Steps/CellOffsets",
	                     (rb_h5_shape){2, {data->steps, KIND_COUNT}}, 0);
	share(h5, data, "Steps/CellOffsets", "Steps/ConnectivityIdOffsets");
}

void rb_polydata_count(struct rb_h5 *h5, const struct rb_polydata *data, hsize_t points,
                       hsize_t cells, hsize_t corners)
{
	char name[48];

	rb_polydata_constant(h5, data, "NumberOfPoints", (rb_h5_shape){1, {1}}, (int64_t)points);
	snprintf(name, sizeof name, "%s/NumberOfCells", data->cells);
	rb_polydata_constant(h5, data, name, (rb_h5_shape){1, {1}}, (int64_t)cells);
	snprintf(name, sizeof name, "%s/NumberOfConnectivityIds", data->cells);
	rb_polydata_constant(h5, data, name, (rb_h5_shape){1, {1}}, (int64_t)corners);
}

void rb_polydata_fixed(struct rb_h5 *h5, const struct rb_polydata *data, const char *of,
                       const char *name)
{
	char offsets[64];

	snprintf(offsets, sizeof offsets, "Steps/%sOffsets/%s", of, name);
	share(h5, data, "Steps/PartOffsets", offsets); /* zeros too: all parts are one */
}

void rb_polydata_moving(struct rb_h5 *h5, const struct rb_polydata *data, const char *name)
{
	char offsets[64], from[RB_POLYDATA_PATH_SIZE], to[RB_POLYDATA_PATH_SIZE];

	snprintf(offsets, sizeof offsets, "Steps/PointDataOffsets/%s", name);
	rb_h5_link(h5, rb_polydata_path(data, "Steps/PointOffsets", from),
	           rb_polydata_path(data, offsets, to));
}
