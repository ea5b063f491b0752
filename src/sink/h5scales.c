/* SPDX-License-Identifier: MIT */
/*
 * The attributes are those that H5DSattach_scale makes (CLASS, NAME and REFERENCE_LIST of a scale,
 * DIMENSION_LIST of what has it), each written once: the library makes that of a scale anew for
 * every dataset, which leaves holes in a header that is to be short (recorder.c).
 *
 * Datasets are noted as they are made and opened by their place: looking all of them up by their
 * paths took three times as many instructions.
 */
#include "sink/h5scales.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

enum { AXES_MAX = RB_H5_RANK_MAX, SCALES = 16, TEXTS_SIZE = 4096 };

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

/* A dataset, by where it stands in the file: opened so, no path has to be looked up. */
struct note {
	char *path; /* owned: of the link that the rule or the scale is of, else the first */
	const struct rule *rule;
	hobj_ref_t reference;
	int rank; /* -1: more than any of ours */
	hsize_t size[AXES_MAX];
};

/* A scale, and the axes that name it. */
struct scale {
	const struct note *note;
	struct use {
		hobj_ref_t dataset;
		uint32_t axis;
	} * uses; /* owned */
	size_t use_count, use_room;
};

struct rb_scales {
	struct note *notes; /* owned */
	size_t note_count, note_room;
	struct rb_h5 *h5; /* while they are written */
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

/* ---- what has been made ---- */

/*
 * The rule for a dataset; NULL: its axes are not named. Names of elements have no slash, those of
 * probes one.
 */
static const struct rule *rule_of(const char *path)
{
	const size_t size = strlen(path);

	if (rb_scales_makes(path))
		return NULL;
	for (size_t k = 0; k < sizeof rules / sizeof rules[0]; k++) {
		const size_t group = strlen(rules[k].group), ending = strlen(rules[k].ending);
		const bool ends = size >= group + ending &&
		                  strncmp(path, rules[k].group, group) == 0 &&
		                  strcmp(path + size - ending, rules[k].ending) == 0;

		if (ends && (ending > 0 || !strchr(path + group, '/')))
			return rules[k].axes[0] ? &rules[k] : NULL;
	}
	return NULL;
}

struct rb_scales *rb_scales_create(const char *time)
{
	struct rb_scales *const scales = rb_memory_take(1, sizeof *scales);

	if (scales)
		*scales = (struct rb_scales){.time = time};
	return scales;
}

void rb_scales_destroy(struct rb_scales *scales)
{
	if (!scales)
		return;
	for (size_t k = 0; k < scales->note_count; k++)
		rb_memory_free(scales->notes[k].path);
	for (int k = 0; k < scales->count; k++)
		rb_memory_free(scales->all[k].uses);
	rb_memory_free(scales->notes);
	rb_memory_free(scales);
}

static void no_memory(struct rb_h5 *h5, const char *path)
{
	if (!h5->status)
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY, "cannot write '%s': out of memory",
		                     path);
}

size_t rb_scales_note(struct rb_scales *scales, struct rb_h5 *h5, const char *path, hid_t dataset)
{
	if (h5->status)
		return scales->note_count;
	char *const copy = rb_memory_copy_text(path);
	if (!copy || !rb_memory_reserve(&scales->notes, &scales->note_room, scales->note_count + 1,
	                                sizeof *scales->notes)) {
		rb_memory_free(copy);
		no_memory(h5, path);
		return scales->note_count;
	}
	struct note *const note = &scales->notes[scales->note_count];
	const hid_t space = H5Dget_space(dataset);
	*note = (struct note){.path = copy, .rule = rule_of(path)};
	note->rank = H5Sget_simple_extent_ndims(space);
	if (note->rank > AXES_MAX)
		note->rank = -1;
	else if (note->rank > 0)
		H5Sget_simple_extent_dims(space, note->size, NULL);
	rb_h5_done(space);
	if (H5Rcreate(&note->reference, dataset, ".", H5R_OBJECT, -1) < 0)
		rb_h5_fail(h5, "refer to", path);
	return scales->note_count++;
}

/* Whether something can name this dataset's axes, or this dataset, as long as no link does. */
static bool is_of_use(const char *path)
{
	const char *const end = strrchr(path, '/');

	if (rule_of(path) || rb_scales_makes(path) || strcmp(end, "/time") == 0)
		return true;
	for (size_t k = 0; k < sizeof rules / sizeof rules[0]; k++)
		for (int axis = 0; axis < 2; axis++)
			if (rules[k].axes[axis] && strcmp(path, rules[k].axes[axis]) == 0)
				return true;
	return false;
}

void rb_scales_made(void *scales, struct rb_h5 *h5, const char *path, hid_t dataset)
{
	if (is_of_use(path))
		(void)rb_scales_note(scales, h5, path, dataset);
}

void rb_scales_note_link(struct rb_scales *scales, struct rb_h5 *h5, const char *path, size_t which)
{
	RB_ASSERT(which < scales->note_count || h5->status);
	if (h5->status)
		return;
	struct note *const note = &scales->notes[which];
	const struct rule *const rule = note->rule ? NULL : rule_of(path);

	if (!rule && strcmp(path, scales->time ? scales->time : "") != 0)
		return;
	char *const copy = rb_memory_copy_text(path);
	if (!copy) {
		no_memory(h5, path);
		return;
	}
	rb_memory_free(note->path);
	note->path = copy;
	if (rule)
		note->rule = rule;
}

/* ---- scales ---- */

/* The note of what stands at `path`; NULL: nothing. */
static const struct note *note_at(const struct rb_scales *scales, const char *path)
{
	for (size_t k = 0; k < scales->note_count; k++)
		if (strcmp(scales->notes[k].path, path) == 0)
			return &scales->notes[k];
	return NULL;
}

/*
 * Texts of any length each: fixed ones of one letter are what netCDF joins to words. The buffer in
 * which they are converted is not the usual megabyte, which the library fills with zeros.
 */
static void put_texts(struct rb_scales *scales, const char *path, const char *const *texts,
                      hsize_t count)
{
	struct rb_h5 *const h5 = scales->h5;

	if (h5->status)
		return;
	const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate_simple(1, &count, NULL);
	const hid_t links = rb_h5_link_properties(), properties = rb_h5_dataset_properties();
	const hid_t transfer = H5Pcreate(H5P_DATASET_XFER);

	H5Tset_size(type, H5T_VARIABLE);
	H5Tset_cset(type, H5T_CSET_UTF8);
	H5Pset_buffer(transfer, TEXTS_SIZE, NULL, NULL);
	const hid_t dataset = H5Dcreate2(h5->file, path, type, space, links, properties,
	                                 H5P_DEFAULT);
	if (dataset < 0 || H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, transfer, texts) < 0)
		rb_h5_fail(h5, "make", path);
	(void)rb_scales_note(scales, h5, path, dataset);
	rb_h5_done(dataset);
	rb_h5_done(transfer);
	rb_h5_done(properties);
	rb_h5_done(links);
	rb_h5_done(space);
	rb_h5_done(type);
}

/* Numbers from 0 on. */
static void put_numbers(struct rb_scales *scales, const char *path, hsize_t count)
{
	struct rb_h5 *const h5 = scales->h5;
	int32_t *const numbers = h5->status ? NULL : rb_memory_take(count + 1, sizeof *numbers);

	if (!numbers) {
		no_memory(h5, path);
		return;
	}
	for (hsize_t k = 0; k < count; k++)
		numbers[k] = (int32_t)k;
	rb_h5_put(h5, path, RB_H5_I32, (rb_h5_shape){1, {count}}, numbers);
	rb_memory_free(numbers);
}

static void put_made(struct rb_scales *scales)
{
	const struct note *const kinds = note_at(scales, "/joints/kind");
	const hsize_t joints = kinds && kinds->rank == 1 ? kinds->size[0] : 0;

	for (int k = 0; k < MADE_COUNT; k++)
		if (kinds || made[k].size > 2)
			put_texts(scales, made[k].path, made[k].texts, made[k].size);
	if (joints > 0)
		put_numbers(scales, joint_row, joints);
}

/* The scale at `path`, "": times of frames; NULL: there is none. */
static struct scale *scale_at(struct rb_scales *scales, const char *path)
{
	if (*path == '\0')
		path = scales->time;
	if (!path)
		return NULL;
	for (int k = 0; k < scales->count; k++)
		if (strcmp(scales->all[k].note->path, path) == 0)
			return &scales->all[k];
	const struct note *const note = scales->count < SCALES ? note_at(scales, path) : NULL;
	if (!note || note->rank != 1)
		return NULL;
	scales->all[scales->count] = (struct scale){.note = note};
	return &scales->all[scales->count++];
}

/* The scale of an axis that no rule names, by its size; `again`: an axis before it has that one. */
static struct scale *scale_of_size(struct rb_scales *scales, hsize_t size, bool again)
{
	for (int k = 0; k < MADE_COUNT; k++)
		if (made[k].size == size && !(again && strcmp(made[k].path, "/axis") == 0))
			return scale_at(scales, made[k].path);
	return NULL;
}

/* Notes that an axis of a dataset names the scale. */
static void note_use(struct rb_scales *scales, struct scale *scale, hobj_ref_t dataset, int axis)
{
	if (!rb_memory_reserve(&scale->uses, &scale->use_room, scale->use_count + 1,
	                       sizeof *scale->uses)) {
		no_memory(scales->h5, scale->note->path);
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

/* Opens what was noted; negative: failed. */
static hid_t open_noted(struct rb_h5 *h5, const struct note *note)
{
	const hid_t dataset = h5->status ? -1
	                                 : H5Rdereference2(h5->file, H5P_DEFAULT, H5R_OBJECT,
	                                                   &note->reference);

	if (dataset < 0)
		rb_h5_fail(h5, "open", note->path);
	return dataset;
}

/* Names the scales of a dataset's axes, if all have one. `type`: of lists of references. */
static void name_axes(struct rb_scales *scales, const struct note *note, hid_t type)
{
	struct rb_h5 *const h5 = scales->h5;
	struct scale *named[AXES_MAX] = {NULL};
	hobj_ref_t references[AXES_MAX];
	hvl_t list[AXES_MAX];
	bool all = note->rank > 0;

	for (int k = 0; k < note->rank && all; k++) {
		named[k] = k < 2 && note->rule->axes[k]
		                   ? scale_at(scales, note->rule->axes[k])
		                   : scale_of_size(scales, note->size[k],
		                                   k > 0 && named[k - 1] ==
		                                                    scale_at(scales, "/axis"));
		/* a scale names itself by being one */
		all = named[k] && named[k]->note->size[0] == note->size[k] &&
		      named[k]->note != note;
	}
	if (!all)
		return;
	for (int k = 0; k < note->rank && !h5->status; k++) {
		references[k] = named[k]->note->reference;
		list[k] = (hvl_t){1, &references[k]};
		note_use(scales, named[k], note->reference, k);
	}
	const hid_t dataset = open_noted(h5, note);
	if (dataset >= 0)
		put_attribute(h5, dataset, "DIMENSION_LIST", (const hid_t[]){type, type},
		              (hsize_t)note->rank, list);
	rb_h5_done(dataset);
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
	const hid_t dataset = open_noted(h5, scale->note);
	if (dataset < 0)
		return;
	put_text(h5, dataset, "CLASS", "DIMENSION_SCALE");
	put_text(h5, dataset, "NAME", strrchr(scale->note->path, '/') + 1);
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

void rb_scales_write(struct rb_scales *scales, struct rb_h5 *h5, const char *time)
{
	if (h5->status)
		return;
	scales->h5 = h5;
	scales->time = time;
	put_made(scales);
	const hid_t type = H5Tvlen_create(H5T_STD_REF_OBJ);
	/* the notes stay where they are from here on: scales point to them */
	for (size_t k = 0; k < scales->note_count && !h5->status; k++)
		if (scales->notes[k].rule)
			name_axes(scales, &scales->notes[k], type);
	for (int k = 0; k < scales->count; k++)
		finish_scale(h5, &scales->all[k]);
	rb_h5_done(type);
}
