/* SPDX-License-Identifier: MIT */
/*
 * The attributes are those that H5DSattach_scale makes (CLASS, NAME and REFERENCE_LIST of a scale,
 * DIMENSION_LIST of what has it), each written once: the library makes that of a scale anew for
 * every dataset, which leaves holes in a header that is to be short (recorder.c).
 */
#include "sink/h5scales.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

enum { AXES_MAX = RB_H5_RANK_MAX, PATH_SIZE = 512, SCALES = 16 };

/* Scales of axes that have no column: their coordinates are texts. */
static const struct {
	const char *path;
	hsize_t size;
	const char *texts[4];
} made[] = {{"/axis", 3, {"x", "y", "z"}},
            {"/axis_2", 3, {"x", "y", "z"}},
            {"/quaternion", 4, {"w", "x", "y", "z"}},
            {"/limit", 2, {"lower", "upper"}}};
enum { MADE_COUNT = sizeof made / sizeof made[0] };
static const char joint_row[] = "/joints/row";

/*
 * What the axes of datasets below a group are. "": times of frames. The first rule that fits holds;
 * the ledger, which is most datasets of a small recording, is left as it is.
 */
static const struct rule {
	const char *group;  /* with the slash */
	const char *ending; /* after the name of the element */
	const char *axes[2];
} rules[] = {
	{"/observables/ledger/", "/value", {NULL}},
	{"/particles/bodies/", "/value", {"", "/particles/bodies/id"}},
	{"/particles/bodies/", "", {"/particles/bodies/id"}},
	{"/particles/statics/", "", {"/particles/statics/id"}},
	{"/joints/", "/value", {"", joint_row}},
	{"/joints/", "", {joint_row}},
	{"/observables/", "/value", {""}},
	{"/observables/", "/step", {""}},
	{"/particles/bodies/", "/step", {""}},
	{"/joints/", "/step", {""}},
	{"/rbsim/events/", "", {"/rbsim/events/time"}},
	{"/rbsim/contacts/", "", {"/rbsim/contacts/step"}},
};

/* A scale, and the axes that name it. */
struct scale {
	char path[PATH_SIZE];
	hobj_ref_t reference;
	hsize_t size; /* of its one axis */
	struct use {
		hobj_ref_t dataset;
		uint32_t axis;
	} * uses; /* owned */
	size_t use_count, use_room;
};

struct scales {
	struct rb_h5 *h5;
	const char *time;
	struct scale all[SCALES];
	int count;
};

bool rb_scales_makes(const char *path)
{
	bool own = strcmp(path, joint_row) == 0;

	for (int k = 0; k < MADE_COUNT; k++)
		own = own || strcmp(path, made[k].path) == 0;
	return own;
}

bool rb_scales_makes_attribute(const char *name)
{
	return strcmp(name, "CLASS") == 0 || strcmp(name, "NAME") == 0 ||
	       strcmp(name, "DIMENSION_LIST") == 0 || strcmp(name, "REFERENCE_LIST") == 0;
}

/* The size of a dataset's axes; its rank, -1: it is none. */
static int size_of(hid_t dataset, hsize_t size[AXES_MAX])
{
	const hid_t space = H5Dget_space(dataset);
	int rank = H5Sget_simple_extent_ndims(space);

	if (rank > AXES_MAX)
		rank = -1;
	else if (rank > 0)
		H5Sget_simple_extent_dims(space, size, NULL);
	rb_h5_done(space);
	return rank;
}

/* ---- scales ---- */

/* Texts of any length each: fixed ones of one letter are what netCDF joins to words. */
static void put_texts(struct rb_h5 *h5, const char *path, const char *const *texts, hsize_t count)
{
	if (h5->status)
		return;
	const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate_simple(1, &count, NULL);
	const hid_t links = rb_h5_link_properties(), properties = rb_h5_dataset_properties();

	H5Tset_size(type, H5T_VARIABLE);
	H5Tset_cset(type, H5T_CSET_UTF8);
	const hid_t dataset = H5Dcreate2(h5->file, path, type, space, links, properties,
	                                 H5P_DEFAULT);
	if (dataset < 0 || H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts) < 0)
		rb_h5_fail(h5, "make", path);
	rb_h5_done(dataset);
	rb_h5_done(properties);
	rb_h5_done(links);
	rb_h5_done(space);
	rb_h5_done(type);
}

/* Numbers from 0 on. */
static void put_numbers(struct rb_h5 *h5, const char *path, hsize_t count)
{
	int32_t *const numbers = h5->status ? NULL : rb_memory_take(count + 1, sizeof *numbers);

	if (!numbers) {
		if (!h5->status)
			h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY,
			                     "cannot write '%s': out of memory", path);
		return;
	}
	for (hsize_t k = 0; k < count; k++)
		numbers[k] = (int32_t)k;
	rb_h5_put(h5, path, RB_H5_I32, (rb_h5_shape){1, {count}}, numbers);
	rb_memory_free(numbers);
}

static bool is_there(struct rb_h5 *h5, const char *path)
{
	char group[PATH_SIZE];
	const char *const slash = strrchr(path, '/');

	snprintf(group, sizeof group, "%.*s", (int)(slash - path), path);
	return (slash == path || H5Lexists(h5->file, group, H5P_DEFAULT) > 0) &&
	       H5Lexists(h5->file, path, H5P_DEFAULT) > 0;
}

static void put_made(struct rb_h5 *h5)
{
	const bool joints = H5Lexists(h5->file, "/joints", H5P_DEFAULT) > 0;
	hsize_t size[AXES_MAX];

	for (int k = 0; k < MADE_COUNT; k++)
		if (joints || made[k].size > 2)
			put_texts(h5, made[k].path, made[k].texts, made[k].size);
	if (h5->status || !joints)
		return;
	const hid_t kinds = H5Dopen2(h5->file, "/joints/kind", H5P_DEFAULT);
	if (kinds >= 0 && size_of(kinds, size) == 1)
		put_numbers(h5, joint_row, size[0]);
	rb_h5_done(kinds);
}

/* The scale at `path`; NULL: there is none. */
static struct scale *scale_at(struct scales *scales, const char *path)
{
	hsize_t size[AXES_MAX] = {0};

	if (*path == '\0')
		path = scales->time;
	if (!path)
		return NULL;
	for (int k = 0; k < scales->count; k++)
		if (strcmp(scales->all[k].path, path) == 0)
			return &scales->all[k];
	if (scales->count == SCALES || !is_there(scales->h5, path))
		return NULL;
	struct scale *const scale = &scales->all[scales->count];
	const hid_t dataset = H5Dopen2(scales->h5->file, path, H5P_DEFAULT);
	const bool is_scale = dataset >= 0 && size_of(dataset, size) == 1 &&
	                      H5Rcreate(&scale->reference, dataset, ".", H5R_OBJECT, -1) >= 0;
	rb_h5_done(dataset);
	if (!is_scale)
		return NULL;
	snprintf(scale->path, sizeof scale->path, "%s", path);
	scale->size = size[0];
	scales->count++;
	return scale;
}

/* The scale of an axis that no rule names, by its size; `again`: an axis before it has that one. */
static struct scale *scale_of_size(struct scales *scales, hsize_t size, bool again)
{
	for (int k = 0; k < MADE_COUNT; k++)
		if (made[k].size == size && !(again && strcmp(made[k].path, "/axis") == 0))
			return scale_at(scales, made[k].path);
	return NULL;
}

/* Notes that an axis of a dataset names the scale. */
static void note_use(struct scales *scales, struct scale *scale, hobj_ref_t dataset, int axis)
{
	if (!rb_memory_reserve(&scale->uses, &scale->use_room, scale->use_count + 1,
	                       sizeof *scale->uses)) {
		scales->h5->status = RB_FAIL(&scales->h5->error, RB_ERR_MEMORY,
		                             "cannot write '%s': out of memory", scale->path);
		return;
	}
	scale->uses[scale->use_count++] = (struct use){dataset, (uint32_t)axis};
}

/* ---- datasets ---- */

/* Writes an attribute of any type. */
static void put_attribute(struct rb_h5 *h5, hid_t object, const char *name, const hid_t types[2],
                          hsize_t count, const void *value)
{
	const hid_t space = H5Screate_simple(1, &count, NULL);
	const hid_t attribute = H5Acreate2(object, name, types[1], space, H5P_DEFAULT, H5P_DEFAULT);

	if (attribute < 0 || H5Awrite(attribute, types[0], value) < 0)
		rb_h5_fail(h5, "make", name);
	rb_h5_done(attribute);
	rb_h5_done(space);
}

/* Names the scales of a dataset's axes, if all have one. */
static void name_axes(struct scales *scales, const struct rule *rule, const char *path)
{
	struct scale *named[AXES_MAX] = {NULL};
	hsize_t size[AXES_MAX];
	hvl_t list[AXES_MAX];
	hobj_ref_t self;
	const hid_t dataset = H5Dopen2(scales->h5->file, path, H5P_DEFAULT);
	const int rank = dataset < 0 ? 0 : size_of(dataset, size);
	bool all = rank > 0 && H5Aexists(dataset, "DIMENSION_LIST") == 0 &&
	           H5Rcreate(&self, dataset, ".", H5R_OBJECT, -1) >= 0;

	for (int k = 0; k < rank && all; k++) {
		named[k] = k < 2 && rule->axes[k]
		                   ? scale_at(scales, rule->axes[k])
		                   : scale_of_size(scales, size[k],
		                                   k > 0 && named[k - 1] ==
		                                                    scale_at(scales, "/axis"));
		/* a scale names itself by being one */
		all = named[k] && named[k]->size == size[k] && named[k]->reference != self;
	}
	for (int k = 0; k < rank && all; k++) {
		list[k] = (hvl_t){1, &named[k]->reference};
		if (!scales->h5->status)
			note_use(scales, named[k], self, k);
	}
	if (all && !scales->h5->status) {
		const hid_t type = H5Tvlen_create(H5T_STD_REF_OBJ);
		put_attribute(scales->h5, dataset, "DIMENSION_LIST", (const hid_t[]){type, type},
		              (hsize_t)rank, list);
		rb_h5_done(type);
	}
	rb_h5_done(dataset);
}

/* The rule for a dataset; NULL: none. Names of elements have no slash, those of probes one. */
static const struct rule *rule_of(const char *path)
{
	const size_t size = strlen(path);

	for (size_t k = 0; k < sizeof rules / sizeof rules[0]; k++) {
		const size_t group = strlen(rules[k].group), ending = strlen(rules[k].ending);
		const bool ends = size >= group + ending &&
		                  strncmp(path, rules[k].group, group) == 0 &&
		                  strcmp(path + size - ending, rules[k].ending) == 0;

		if (ends && (ending > 0 || !strchr(path + group, '/')))
			return &rules[k];
	}
	return NULL;
}

/* H5Lvisit's callback. */
static herr_t visit(hid_t group, const char *name, const H5L_info_t *link, void *user)
{
	struct scales *const scales = user;
	char path[PATH_SIZE];

	(void)group;
	if (link->type != H5L_TYPE_HARD ||
	    snprintf(path, sizeof path, "/%s", name) >= (int)sizeof path)
		return 0;
	const struct rule *const rule = rule_of(path);
	if (rule && rule->axes[0] && !rb_scales_makes(path))
		name_axes(scales, rule, path);
	return scales->h5->status ? 1 : 0;
}

/* ---- all of it ---- */

/* A text that ends with a zero byte: the library recognises a scale by no other. */
static void put_text(struct rb_h5 *h5, hid_t object, const char *name, const char *text)
{
	const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);

	H5Tset_size(type, strlen(text) + 1);
	const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
	if (attribute < 0 || H5Awrite(attribute, type, text) < 0)
		rb_h5_fail(h5, "make", name);
	rb_h5_done(attribute);
	rb_h5_done(space);
	rb_h5_done(type);
}

/* Makes a dataset a scale: what it is, what it is called, and who names it. */
static void finish_scale(struct rb_h5 *h5, const struct scale *scale)
{
	if (h5->status || scale->use_count == 0)
		return;
	const hid_t dataset = H5Dopen2(h5->file, scale->path, H5P_DEFAULT);
	put_text(h5, dataset, "CLASS", "DIMENSION_SCALE");
	put_text(h5, dataset, "NAME", strrchr(scale->path, '/') + 1);
	const hid_t memory = H5Tcreate(H5T_COMPOUND, sizeof(struct use));
	H5Tinsert(memory, "dataset", HOFFSET(struct use, dataset), H5T_STD_REF_OBJ);
	H5Tinsert(memory, "dimension", HOFFSET(struct use, axis), H5T_NATIVE_UINT32);
	const hid_t file = H5Tcreate(H5T_COMPOUND, 12);
	H5Tinsert(file, "dataset", 0, H5T_STD_REF_OBJ);
	H5Tinsert(file, "dimension", 8, H5T_STD_U32LE);
	put_attribute(h5, dataset, "REFERENCE_LIST", (const hid_t[]){memory, file},
	              scale->use_count, scale->uses);
	rb_h5_done(file);
	rb_h5_done(memory);
	rb_h5_done(dataset);
}

void rb_scales_write(struct rb_h5 *h5, const char *time)
{
	if (h5->status)
		return;
	struct scales *const scales = rb_memory_take(1, sizeof *scales);
	if (!scales) {
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY, "cannot name axes: out of memory");
		return;
	}
	*scales = (struct scales){.h5 = h5, .time = time};
	put_made(h5);
	if (!h5->status && H5Lvisit(h5->file, H5_INDEX_NAME, H5_ITER_INC, visit, scales) < 0)
		rb_h5_fail(h5, "read", "/");
	for (int k = 0; k < scales->count; k++) {
		finish_scale(h5, &scales->all[k]);
		rb_memory_free(scales->all[k].uses);
	}
	rb_memory_free(scales);
}
