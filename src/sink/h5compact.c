/* SPDX-License-Identifier: MIT */
/*
 * The file is copied object by object, not by H5Ocopy, because that keeps chunks and their indices,
 * which are what is to go. Data are read and written in the type that they have on disk, so they
 * stay the same to the bit. Hard links are recognised by the address of their object: it is copied
 * at the first link, and linked at the others.
 *
 * The result is made in memory by the core driver; only files of at most RB_COMPACT_MOST are
 * compacted.
 */
#include "sink/h5compact.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "sink/h5file.h"
#include "sink/h5mark.h"
#include "sink/h5scales.h"

enum {
	DEPTH_MAX = 32,       /* of groups in each other */
	PATH_MOST = 1024,     /* bytes of an object's path */
	LINKS_IN_HEADER = 64, /* of a group, before they get an index of their own */
	ZEROS_MOST = 1024     /* bytes of a dataset of zeros that is not written */
};
#define NOT_NOTED SIZE_MAX

/* An object that has been copied, by where it stands in the old file. */
struct copied {
	unsigned char address[16];
	char *path;   /* owned */
	size_t noted; /* its number among those whose axes are named; NOT_NOTED: it is none */
};

struct compaction {
	struct rb_h5 h5;          /* the new file */
	struct rb_scales *scales; /* owned; NULL: axes are not named */
	struct copied *copied;
	size_t count, capacity;
};

#if H5_VERSION_GE(1, 12, 0)
/*
 * Where the object of a hard link stands, as 16 bytes: its token from HDF5 1.12 on, its address
 * before.
 */
static void address_of(const H5L_info_t *link, unsigned char out[16])
{
	memcpy(out, &link->u.token, sizeof link->u.token);
}
#else
static void address_of(const H5L_info_t *link, unsigned char out[16])
{
	memset(out, 0, 16);
	memcpy(out, &link->u.address, sizeof link->u.address);
}
#endif

/* Records a failure of the library. */
static void fail(struct compaction *to, const char *path)
{
	rb_h5_fail(&to->h5, "copy", path);
}

/* Records a failure, unless one stands already. */
static void no_memory(struct compaction *to)
{
	if (!to->h5.status)
		to->h5.status = RB_FAIL(&to->h5.error, RB_ERR_MEMORY,
		                        "cannot copy '%s': out of memory", to->h5.name);
}

/* ---- values ---- */

/*
 * Memory for all elements of a dataspace, to be freed; `count`: of them. NULL: no memory, or no
 * such space.
 */
static void *room_for(struct compaction *to, hid_t space, hid_t type, hssize_t *count)
{
	*count = H5Sget_simple_extent_npoints(space);
	void *const room = *count < 0 ? NULL
	                              : rb_memory_take((size_t)*count + 1, H5Tget_size(type));

	if (!room)
		no_memory(to);
	return room;
}

/* Copies the index-th attribute of `from` to `object`. */
static void copy_attribute(struct compaction *to, hid_t from, hid_t object, hsize_t index,
                           const char *path)
{
	char name[PATH_MOST] = "";
	hssize_t count = 0;
	const bool named = H5Aget_name_by_idx(from, ".", H5_INDEX_NAME, H5_ITER_INC, index, name,
	                                      sizeof name, H5P_DEFAULT) >= 0;

	/* those of scales point to places in the old file: they are made anew at the end */
	if (named && rb_scales_makes_attribute(name))
		return;
	const hid_t old = named ? H5Aopen(from, name, H5P_DEFAULT) : -1;
	const hid_t type = old < 0 ? -1 : H5Aget_type(old);
	const hid_t space = old < 0 ? -1 : H5Aget_space(old);
	const hid_t properties = old < 0 ? -1 : H5Aget_create_plist(old);
	const hid_t made = properties < 0
	                           ? -1
	                           : H5Acreate2(object, name, type, space, properties, H5P_DEFAULT);
	void *const value = made < 0 ? NULL : room_for(to, space, type, &count);

	if (made < 0 || (value && count > 0 &&
	                 (H5Aread(old, type, value) < 0 || H5Awrite(made, type, value) < 0)))
		fail(to, path);
	rb_memory_free(value);
	rb_h5_done(made);
	rb_h5_done(properties);
	rb_h5_done(space);
	rb_h5_done(type);
	rb_h5_done(old);
}

/* Copies all attributes, in the order of their names. */
static void copy_attributes(struct compaction *to, hid_t from, hid_t object, const char *path)
{
	H5O_info_t info;

#if H5_VERSION_GE(1, 12, 0)
	const bool known = H5Oget_info(from, &info, H5O_INFO_NUM_ATTRS) >= 0;
#else
	const bool known = H5Oget_info(from, &info) >= 0;
#endif
	if (!known)
		fail(to, path);
	for (hsize_t k = 0; !to->h5.status && k < info.num_attrs; k++)
		copy_attribute(to, from, object, k, path);
}

/* ---- datasets ---- */

/*
 * Properties for the copy of a dataset; to be closed. One that grew becomes contiguous, or one
 * chunk where it is compressed.
 */
static hid_t layout_of(hid_t old, hid_t space, bool zero)
{
	const hid_t was = H5Dget_create_plist(old);
	hid_t properties = was;

	if (was >= 0 && zero)
		H5Pset_fill_time(was, H5D_FILL_TIME_IFSET);
	if (was < 0 || H5Pget_layout(was) != H5D_CHUNKED)
		return was;
	if (H5Pget_nfilters(was) > 0) {
		hsize_t size[H5S_MAX_RANK];
		const int rank = H5Sget_simple_extent_dims(space, size, NULL);

		for (int k = 0; k < rank; k++)
			size[k] += size[k] == 0;
		H5Pset_chunk(properties, rank, size);
		return properties;
	}
	properties = rb_h5_dataset_properties();
	H5Pset_fill_time(properties, zero ? H5D_FILL_TIME_IFSET : H5D_FILL_TIME_NEVER);
	rb_h5_done(was);
	return properties;
}

/* Whether what is not written of a dataset reads as zeros. */
static bool fills_zero(hid_t dataset)
{
	const hid_t properties = H5Dget_create_plist(dataset);
	H5D_fill_value_t fill = H5D_FILL_VALUE_ERROR;
	const bool known = properties >= 0 && H5Pfill_value_defined(properties, &fill) >= 0;

	rb_h5_done(properties);
	return known && fill == H5D_FILL_VALUE_DEFAULT;
}

static bool is_zero(const unsigned char *bytes, size_t size)
{
	for (size_t k = 0; k < size; k++)
		if (bytes[k] != 0)
			return false;
	return true;
}

/* Copies a dataset without its attributes; its id, negative: failed. */
static hid_t make_dataset(struct compaction *to, hid_t group, const char *name, hid_t old,
                          const char *path)
{
	const hid_t type = H5Dget_type(old), was = H5Dget_space(old), space = H5Scopy(was);
	hsize_t size[H5S_MAX_RANK];
	const int rank = H5Sget_simple_extent_dims(was, size, NULL);

	if (rank > 0)
		H5Sset_extent_simple(space, rank, size, NULL);
	hssize_t count = 0;
	unsigned char *const value = H5Dget_storage_size(old) > 0 ? room_for(to, was, type, &count)
	                                                          : NULL;
	const bool read = value && count > 0;
	if (read && H5Dread(old, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) < 0)
		fail(to, path);
	/*
	 * What is never written reads as zeros: causes that the scene lacks, moments at rest. Of
	 * long columns, which are not what is small about a recording, estimates could not know.
	 */
	const size_t bytes = (size_t)count * H5Tget_size(type);
	const bool zero = read && bytes <= ZEROS_MOST && fills_zero(old) && is_zero(value, bytes);
	const hid_t properties = layout_of(old, space, zero), links = rb_h5_link_properties();
#if H5_VERSION_GE(1, 10, 5)
	H5Pset_dset_no_attrs_hint(properties, true);
#endif
	const hid_t made = H5Dcreate2(group, name, type, space, links, properties, H5P_DEFAULT);

	if (made < 0 ||
	    (read && !zero && H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) < 0))
		fail(to, path);
	rb_memory_free(value);
	rb_h5_done(links);
	rb_h5_done(properties);
	rb_h5_done(space);
	rb_h5_done(was);
	rb_h5_done(type);
	return made;
}

/* ---- groups ---- */

/* Whether the members of a group keep the order in which they were made. */
static bool is_ordered(hid_t group)
{
	const hid_t properties = H5Gget_create_plist(group);
	unsigned order = 0;

	if (properties >= 0)
		H5Pget_link_creation_order(properties, &order);
	rb_h5_done(properties);
	return order & H5P_CRT_ORDER_INDEXED;
}

/* Asks for a header that has room for the links of the old group, and for no more. */
static void fit_links(hid_t properties, hid_t old)
{
	H5G_info_t info;
	size_t bytes = 0;

	if (H5Gget_info(old, &info) < 0 || info.nlinks == 0 || info.nlinks > LINKS_IN_HEADER)
		return;
	for (hsize_t k = 0; k < info.nlinks; k++) {
		const ssize_t size = H5Lget_name_by_idx(old, ".", H5_INDEX_NAME, H5_ITER_INC, k,
		                                        NULL, 0, H5P_DEFAULT);
		bytes += size > 0 ? (size_t)size : 0;
	}
	H5Pset_est_link_info(properties, (unsigned)info.nlinks,
	                     (unsigned)(bytes / info.nlinks + 1));
}

/*
 * Makes a group like the old one; its id, negative: failed. The old one's properties would not do:
 * they hold where its own index stands.
 */
static hid_t make_group(hid_t group, const char *name, hid_t old)
{
	const hid_t properties = H5Pcreate(H5P_GROUP_CREATE), links = rb_h5_link_properties();

	H5Pset_obj_track_times(properties, 0);
	H5Pset_link_phase_change(properties, LINKS_IN_HEADER, LINKS_IN_HEADER);
	fit_links(properties, old);
	if (is_ordered(old))
		H5Pset_link_creation_order(properties,
		                           H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
	const hid_t made = H5Gcreate2(group, name, links, properties, H5P_DEFAULT);
	rb_h5_done(links);
	rb_h5_done(properties);
	return made;
}

/* The copy of the object at this address; NULL: it has not been copied. */
static const struct copied *copy_of(const struct compaction *to, const unsigned char address[16])
{
	for (size_t k = 0; k < to->count; k++)
		if (memcmp(to->copied[k].address, address, 16) == 0)
			return &to->copied[k];
	return NULL;
}

/* Notes that the object at this address is copied to `path`. */
static void remember(struct compaction *to, const unsigned char address[16], const char *path)
{
	RB_ASSERT(to->count <= to->capacity);
	if (!rb_memory_reserve(&to->copied, &to->capacity, to->count + 1, sizeof *to->copied)) {
		no_memory(to);
		return;
	}
	struct copied *const copied = &to->copied[to->count];
	memcpy(copied->address, address, 16);
	copied->path = rb_memory_copy_text(path);
	copied->noted = NOT_NOTED;
	if (copied->path)
		to->count++;
	else
		no_memory(to);
}

static void copy_members(struct compaction *to, hid_t from, hid_t group, const char *path,
                         int depth);

/* Copies a group or dataset with all that is in it. */
static void copy_object(struct compaction *to, hid_t from, hid_t group, const char *name,
                        const char *path, int depth)
{
	const hid_t old = H5Oopen(from, name, H5P_DEFAULT);
	const bool is_group = old >= 0 && H5Iget_type(old) == H5I_GROUP;
	hid_t made = -1;

	if (is_group)
		made = make_group(group, name, old);
	else if (old >= 0 && H5Iget_type(old) == H5I_DATASET)
		made = make_dataset(to, group, name, old, path);
	/* the last that is remembered is this one */
	if (made >= 0 && !is_group && to->scales && !to->h5.status)
		to->copied[to->count - 1].noted = rb_scales_note(to->scales, &to->h5, path, made);
	if (made < 0)
		fail(to, path);
	if (!to->h5.status)
		copy_attributes(to, old, made, path);
	if (is_group && !to->h5.status)
		copy_members(to, old, made, path, depth + 1);
	rb_h5_done(made);
	rb_h5_done(old);
}

/* Copies a soft link as it is. */
static void copy_soft(struct compaction *to, hid_t from, hid_t group, const char *name,
                      const char *path)
{
	const hid_t links = rb_h5_link_properties();
	char value[PATH_MOST];

	if (H5Lget_val(from, name, value, sizeof value, H5P_DEFAULT) < 0 ||
	    H5Lcreate_soft(value, group, name, links, H5P_DEFAULT) < 0)
		fail(to, path);
	rb_h5_done(links);
}

/* Copies one link and, at the first that leads to it, its object. */
static void copy_link(struct compaction *to, hid_t from, hid_t group, const char *name,
                      const char *parent, int depth)
{
	unsigned char address[16];
	char path[PATH_MOST];
	H5L_info_t link;

	RB_ASSERT(depth >= 0);
	if (snprintf(path, sizeof path, "%s/%s", parent, name) >= (int)sizeof path ||
	    H5Lget_info(from, name, &link, H5P_DEFAULT) < 0 ||
	    (link.type != H5L_TYPE_HARD && link.type != H5L_TYPE_SOFT)) {
		fail(to, path);
		return;
	}
	if (rb_scales_makes(path))
		return;
	if (link.type == H5L_TYPE_SOFT) {
		copy_soft(to, from, group, name, path);
		return;
	}
	address_of(&link, address);
	const struct copied *const there = copy_of(to, address);
	if (there) {
		rb_h5_link(&to->h5, there->path, path);
		if (there->noted != NOT_NOTED)
			rb_scales_note_link(to->scales, &to->h5, path, there->noted);
		return;
	}
	remember(to, address, path);
	if (!to->h5.status)
		copy_object(to, from, group, name, path, depth);
}

/* Copies all links of a group. */
static void copy_members(struct compaction *to, hid_t from, hid_t group, const char *path,
                         int depth)
{
	const H5_index_t index = is_ordered(from) ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
	H5G_info_t info;

	RB_ASSERT(depth >= 0);
	if (H5Gget_info(from, &info) < 0 || depth > DEPTH_MAX)
		fail(to, path);
	for (hsize_t k = 0; !to->h5.status && k < info.nlinks; k++) {
		char name[PATH_MOST];

		if (H5Lget_name_by_idx(from, ".", index, H5_ITER_INC, k, name, sizeof name,
		                       H5P_DEFAULT) < 0)
			fail(to, path);
		else
			copy_link(to, from, group, name, path, depth);
	}
}

/* ---- the file ---- */

/* An empty file in memory, without room for growth; negative: failed. */
static hid_t create_in_memory(void)
{
	const hid_t access = rb_h5_access(1), creation = H5Pcreate(H5P_FILE_CREATE);

	/* a name that no file can have, so that none is looked at */
	H5Pset_fapl_core(access, 1 << 16, 0);
	H5Pset_meta_block_size(access, 0); /* nothing is taken in advance */
	H5Pset_small_data_block_size(access, 0);
	H5Pset_obj_track_times(creation, 0);
	H5Pset_link_phase_change(creation, LINKS_IN_HEADER, LINKS_IN_HEADER);
	const hid_t file = H5Fcreate("/dev/null/compact", H5F_ACC_EXCL, creation, access);
	rb_h5_done(creation);
	rb_h5_done(access);
	return file;
}

/* The bytes of the file in memory, marked as closed. */
static void take_image(struct compaction *to, unsigned char **image, size_t *size)
{
	const ssize_t bytes = H5Fflush(to->h5.file, H5F_SCOPE_LOCAL) < 0
	                              ? -1
	                              : H5Fget_file_image(to->h5.file, NULL, 0);

	if (bytes <= 0) {
		fail(to, "/");
		return;
	}
	*image = rb_memory_take((size_t)bytes, 1);
	*size = (size_t)bytes;
	if (!*image)
		no_memory(to);
	else if (H5Fget_file_image(to->h5.file, *image, *size) != bytes)
		fail(to, "/");
	else
		rb_mark_image(*image, *size);
}

enum rb_status rb_compact_image(hid_t file, const char *name, const char *time,
                                unsigned char **image, size_t *size, struct rb_error *err)
{
	struct compaction to = {.h5 = {.name = name, .file = create_in_memory()},
	                        .scales = time ? rb_scales_create(time) : NULL};
	const hid_t from = H5Gopen2(file, "/", H5P_DEFAULT);
	const hid_t root = to.h5.file < 0 ? -1 : H5Gopen2(to.h5.file, "/", H5P_DEFAULT);

	*image = NULL;
	if (from < 0 || root < 0)
		fail(&to, "/");
	if (time && !to.scales)
		no_memory(&to);
	to.h5.made = to.scales ? rb_scales_made : NULL;
	to.h5.user = to.scales;
	if (!to.h5.status)
		copy_attributes(&to, from, root, "/");
	if (!to.h5.status)
		copy_members(&to, from, root, "", 0);
	if (to.scales)
		rb_scales_write(to.scales, &to.h5, time);
	rb_scales_destroy(to.scales);
	rb_h5_done(root);
	rb_h5_done(from);
	if (!to.h5.status)
		take_image(&to, image, size);
	for (size_t k = 0; k < to.count; k++)
		rb_memory_free(to.copied[k].path);
	rb_memory_free(to.copied);
	if (to.h5.file >= 0)
		H5Fclose(to.h5.file);
	if (to.h5.status) {
		rb_memory_free(*image);
		*image = NULL;
		if (err)
			*err = to.h5.error;
	}
	return to.h5.status;
}
