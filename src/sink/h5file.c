/* SPDX-License-Identifier: MIT */
/*
 * The library's errors are a stack of its own; what a user needs of it is the innermost text and
 * the system's errno, which HDF5 hides in a text ("errno = 28"). All ids are closed by rb_h5_done,
 * whatever their kind, so that every function has one way out: it makes all ids, checks the last,
 * and closes all, of which some may be -1.
 *
 * Objects are made without times and with fixed properties: two equal runs give equal bytes.
 */
#include "sink/h5file.h"

#include "base/error.h"
#include "base/memory.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNED_FROM = 16 }; /* bytes: smaller objects may stand anywhere */

hid_t rb_h5_type(enum rb_h5_kind kind)
{
	switch (kind) {
	case RB_H5_F64:
		return H5T_NATIVE_DOUBLE;
	case RB_H5_F32:
		return H5T_NATIVE_FLOAT;
	case RB_H5_I64:
		return H5T_NATIVE_INT64;
	case RB_H5_U64:
		return H5T_NATIVE_UINT64;
	case RB_H5_I32:
		return H5T_NATIVE_INT32;
	case RB_H5_U8:
		return H5T_NATIVE_UINT8;
	default:
		return H5T_NATIVE_INT8;
	}
}

hid_t rb_h5_type_file(enum rb_h5_kind kind)
{
	switch (kind) {
	case RB_H5_F64:
		return H5T_IEEE_F64LE;
	case RB_H5_F32:
		return H5T_IEEE_F32LE;
	case RB_H5_I64:
		return H5T_STD_I64LE;
	case RB_H5_U64:
		return H5T_STD_U64LE;
	case RB_H5_I32:
		return H5T_STD_I32LE;
	case RB_H5_U8:
		return H5T_STD_U8LE;
	default:
		return H5T_STD_I8LE;
	}
}

size_t rb_h5_size(enum rb_h5_kind kind)
{
	static const size_t size[RB_H5_KIND_COUNT] = {8, 4, 8, 8, 4, 1, 1};

	RB_ASSERT((unsigned)kind < RB_H5_KIND_COUNT);
	return size[kind];
}

void rb_h5_quiet(void)
{
	H5dont_atexit(); /* refused once the library has started: it was then called before */
	H5open();
	H5PLset_loading_state(0);
	H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

hid_t rb_h5_access(unsigned attempts)
{
	const hid_t access = H5Pcreate(H5P_FILE_ACCESS);

	RB_ASSERT(attempts > 0);
	/* whatever version this one is */
	H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
	H5Pset_metadata_read_attempts(access, attempts);
	return access;
}

hid_t rb_h5_access_aligned(unsigned alignment)
{
	const hid_t access = rb_h5_access(1);

	RB_ASSERT(alignment >= 1);
	H5Pset_alignment(access, ALIGNED_FROM, alignment);
	if (alignment > 1)
		H5Pset_meta_block_size(access, 0);
	H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
	return access;
}

hid_t rb_h5_create(const char *path, hid_t access)
{
	const hid_t creation = H5Pcreate(H5P_FILE_CREATE);

	/* room in the root's header for all its links: /VTKHDF is added without moving anything */
	H5Pset_est_link_info(creation, 8, 12);
	H5Pset_obj_track_times(creation, 0);
	const hid_t file = H5Fcreate(path, H5F_ACC_EXCL, creation, access);
	rb_h5_done(creation);
	return file;
}

void rb_h5_done(hid_t id)
{
	if (id < 0)
		return;
	/* closing empties the stack, and who tells what failed closes before */
	const hid_t failure = H5Eget_num(H5E_DEFAULT) > 0 ? H5Eget_current_stack() : -1;
	H5Idec_ref(id);
	if (failure >= 0)
		H5Eset_current_stack(failure);
}

/* What the library's error stack tells. */
struct seen {
	int number;
	char text[160]; /* of the innermost failure */
};

/* For H5Ewalk2, from the innermost failure outwards. */
static herr_t look(unsigned depth, const H5E_error2_t *entry, void *user)
{
	struct seen *seen = user;
	const char *text = entry->desc ? entry->desc : "";
	const char *number = strstr(text, "errno = ");

	if (depth == 0)
		snprintf(seen->text, sizeof seen->text, "%s", text);
	if (number && seen->number == 0)
		seen->number = atoi(number + strlen("errno = "));
	return 0;
}

/* Reads this thread's error stack without changing it. */
static struct seen look_at_stack(void)
{
	struct seen seen = {.number = 0};

	H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, look, &seen);
	return seen;
}

int rb_h5_errno(void)
{
	return look_at_stack().number;
}

const char *rb_h5_reason(char out[160])
{
	const struct seen seen = look_at_stack();

	if (seen.number != 0)
		snprintf(out, 160, "%s", strerror(seen.number));
	else
		snprintf(out, 160, "HDF5: %.150s", seen.text[0] ? seen.text : "unknown failure");
	return out;
}

void rb_h5_fail(struct rb_h5 *h5, const char *what, const char *path)
{
	char reason[160];

	if (h5->status)
		return;
	if (strcmp(path, "/") == 0) /* the whole file */
		h5->status = RB_FAIL(&h5->error, RB_ERR_IO, "cannot %s '%s': %s", what, h5->name,
		                     rb_h5_reason(reason));
	else
		h5->status = RB_FAIL(&h5->error, RB_ERR_IO, "cannot %s '%s' in '%s': %s", what,
		                     path, h5->name, rb_h5_reason(reason));
}

void rb_h5_made(struct rb_h5 *h5, const char *path, hid_t dataset)
{
	if (h5->made && !h5->status)
		h5->made(h5->user, h5, path, dataset);
}

hid_t rb_h5_dataset_properties(void)
{
	const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);

	H5Pset_obj_track_times(properties, 0);
	return properties;
}

/*
 * Lists that never change, made once: a recording makes some hundred objects, and making lists for
 * each took a tenth of the time. Protected by the lock; made anew where a host has closed the
 * library.
 */
static struct {
	pthread_mutex_t lock;
	hid_t links;    /* of all links */
	hid_t at_once;  /* of datasets that have their space from the start */
	hid_t uncached; /* to open datasets whose chunks are not cached */
} shared = {PTHREAD_MUTEX_INITIALIZER, -1, -1, -1};

/* One more owner of a shared list, for rb_h5_done. */
static hid_t share(const hid_t *list, hid_t class)
{
	pthread_mutex_lock(&shared.lock);
	if (*list < 0 || H5Pisa_class(*list, class) <= 0) {
		shared.links = H5Pcreate(H5P_LINK_CREATE);
		H5Pset_create_intermediate_group(shared.links, 1);
		H5Pset_char_encoding(shared.links, H5T_CSET_UTF8);
		shared.at_once = rb_h5_dataset_properties();
		H5Pset_alloc_time(shared.at_once, H5D_ALLOC_TIME_EARLY);
		H5Pset_fill_time(shared.at_once, H5D_FILL_TIME_NEVER);
		shared.uncached = H5Pcreate(H5P_DATASET_ACCESS);
		H5Pset_chunk_cache(shared.uncached, 0, 0, 1.0);
	}
	const hid_t shared_list = *list;
	if (shared_list >= 0)
		H5Iinc_ref(shared_list);
	pthread_mutex_unlock(&shared.lock);
	return shared_list;
}

hid_t rb_h5_link_properties(void)
{
	return share(&shared.links, H5P_LINK_CREATE);
}

hid_t rb_h5_uncached_properties(void)
{
	return share(&shared.uncached, H5P_DATASET_ACCESS);
}

/* Makes a group; `ordered`: its members keep the order in which they were made. */
static void make_group(struct rb_h5 *h5, const char *path, bool ordered)
{
	if (h5->status)
		return;
	const hid_t links = rb_h5_link_properties();
	const hid_t properties = H5Pcreate(H5P_GROUP_CREATE);
	H5Pset_obj_track_times(properties, 0);
	if (ordered)
		H5Pset_link_creation_order(properties,
		                           H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
	const hid_t group = H5Gcreate2(h5->file, path, links, properties, H5P_DEFAULT);

	if (group < 0)
		rb_h5_fail(h5, "make", path);
	rb_h5_done(group);
	rb_h5_done(properties);
	rb_h5_done(links);
}

void rb_h5_group(struct rb_h5 *h5, const char *path)
{
	make_group(h5, path, false);
}

void rb_h5_group_ordered(struct rb_h5 *h5, const char *path)
{
	make_group(h5, path, true);
}

/* A dataspace of fixed size; to be closed. */
static hid_t make_space(rb_h5_shape shape)
{
	RB_ASSERT(shape.rank >= 0 && shape.rank <= RB_H5_RANK_MAX);
	return shape.rank == 0 ? H5Screate(H5S_SCALAR)
	                       : H5Screate_simple(shape.rank, shape.size, NULL);
}

/*
 * Makes a dataset and writes it (`data` NULL: not). type[0] on disk, type[1] in memory. It is given
 * space at once, so that it can be overwritten when the disk is full.
 */
static void put(struct rb_h5 *h5, const char *path, const hid_t type[2], rb_h5_shape shape,
                const void *data)
{
	RB_ASSERT(shape.rank >= 0 && shape.rank <= RB_H5_RANK_MAX);
	if (h5->status)
		return;
	const hid_t space = make_space(shape);
	const hid_t links = rb_h5_link_properties();
	const hid_t properties = share(&shared.at_once, H5P_DATASET_CREATE);
	const hid_t dataset = H5Dcreate2(h5->file, path, type[0], space, links, properties,
	                                 H5P_DEFAULT);
	bool failed = dataset < 0;

	for (int i = 0; i < shape.rank; i++)
		if (shape.size[i] == 0)
			data = NULL;
	if (!failed && data)
		failed = H5Dwrite(dataset, type[1], H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0;
	if (failed)
		rb_h5_fail(h5, "write", path);
	rb_h5_made(h5, path, dataset);
	rb_h5_done(dataset);
	rb_h5_done(properties);
	rb_h5_done(links);
	rb_h5_done(space);
}

void rb_h5_put(struct rb_h5 *h5, const char *path, enum rb_h5_kind kind, rb_h5_shape shape,
               const void *data)
{
	const hid_t type[2] = {rb_h5_type_file(kind), rb_h5_type(kind)};

	put(h5, path, type, shape, data);
}

void rb_h5_put_f64(struct rb_h5 *h5, const char *path, double value)
{
	rb_h5_put(h5, path, RB_H5_F64, (rb_h5_shape){0}, &value);
}

void rb_h5_put_i64(struct rb_h5 *h5, const char *path, int64_t value)
{
	rb_h5_put(h5, path, RB_H5_I64, (rb_h5_shape){0}, &value);
}

/* A type of fixed length, at least 1, which HDF5 demands; to be closed. */
static hid_t text_type(size_t size)
{
	const hid_t type = H5Tcopy(H5T_C_S1);

	H5Tset_size(type, size > 0 ? size : 1);
	H5Tset_strpad(type, H5T_STR_NULLPAD);
	H5Tset_cset(type, H5T_CSET_UTF8);
	return type;
}

/* Bytes of a text that fit into `room`, cut between characters of UTF-8. */
static size_t cut_text(const char *text, size_t room)
{
	size_t size = strlen(text);

	if (size <= room)
		return size;
	for (size = room; size > 0 && ((unsigned char)text[size] & 0xc0) == 0x80;)
		size--;
	return size;
}

/* Writes `size` bytes of a text into a dataset of `room` bytes, padded with zeros. */
static void put_text(struct rb_h5 *h5, const char *path, const char *text, size_t size, size_t room)
{
	RB_ASSERT(size <= room);
	if (h5->status)
		return;
	char *copy = rb_memory_take(room + 1, 1);
	if (!copy) {
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY, "cannot record '%s': out of memory",
		                     path);
		return;
	}
	memcpy(copy, text, size);
	const hid_t type = text_type(room);
	put(h5, path, (const hid_t[2]){type, type}, (rb_h5_shape){0}, copy);
	rb_h5_done(type);
	rb_memory_free(copy);
}

void rb_h5_text(struct rb_h5 *h5, const char *path, const char *text, size_t room)
{
	if (!text)
		text = "";
	if (room == 0)
		room = strlen(text);
	put_text(h5, path, text, cut_text(text, room), room);
}

void rb_h5_text_sized(struct rb_h5 *h5, const char *path, const char *text, size_t size)
{
	put_text(h5, path, text, size, size);
}

void rb_h5_texts(struct rb_h5 *h5, const char *path, const char *const *texts, size_t count)
{
	size_t longest = 1;

	if (h5->status)
		return;
	for (size_t i = 0; i < count; i++)
		if (texts[i] && strlen(texts[i]) > longest)
			longest = strlen(texts[i]);
	char *cells = rb_memory_take(count, longest);
	if (!cells) {
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY, "cannot record '%s': out of memory",
		                     path);
		return;
	}
	for (size_t i = 0; i < count; i++)
		if (texts[i])
			memcpy(cells + i * longest, texts[i], strlen(texts[i]));
	const hid_t type = text_type(longest);
	put(h5, path, (const hid_t[2]){type, type}, (rb_h5_shape){1, {count}}, cells);
	rb_h5_done(type);
	rb_memory_free(cells);
}

void rb_h5_retext(struct rb_h5 *h5, const char *path, const char *text)
{
	if (h5->status)
		return;
	const hid_t dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);
	const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);
	const size_t room = type < 0 ? 0 : H5Tget_size(type);
	char copy[RB_H5_RETEXT_MAX] = {
		0}; /* nothing is allocated: the run may have ended for want of memory */

	/* the length is fixed when the dataset is made: H5Dwrite cannot change it */
	if (room > 0 && room <= sizeof copy) {
		memcpy(copy, text, cut_text(text, room));
		if (H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, copy) < 0)
			rb_h5_fail(h5, "write", path);
	} else {
		rb_h5_fail(h5, "write", path);
	}
	rb_h5_done(type);
	rb_h5_done(dataset);
}

void rb_h5_rewrite_f64(struct rb_h5 *h5, const char *path, double value)
{
	if (h5->status)
		return;
	const hid_t dataset = H5Dopen2(h5->file, path, H5P_DEFAULT);

	if (dataset < 0 ||
	    H5Dwrite(dataset, rb_h5_type(RB_H5_F64), H5S_ALL, H5S_ALL, H5P_DEFAULT, &value) < 0)
		rb_h5_fail(h5, "write", path);
	rb_h5_done(dataset);
}

/* Makes an attribute of the object at `path`; closes `space`. */
static void put_attribute(struct rb_h5 *h5, const char *path, const char *name, const hid_t type[2],
                          hid_t space, const void *data)
{
	const hid_t attribute = H5Acreate_by_name(h5->file, path, name, type[0], space, H5P_DEFAULT,
	                                          H5P_DEFAULT, H5P_DEFAULT);

	if (attribute < 0 || H5Awrite(attribute, type[1], data) < 0)
		rb_h5_fail(h5, "describe", path);
	rb_h5_done(attribute);
	rb_h5_done(space);
}

void rb_h5_attribute(struct rb_h5 *h5, const char *path, const char *name, enum rb_h5_kind kind,
                     int count, const void *data)
{
	const hid_t type[2] = {rb_h5_type_file(kind), rb_h5_type(kind)};

	RB_ASSERT(count >= 0);
	if (h5->status)
		return;
	put_attribute(h5, path, name, type, make_space((rb_h5_shape){count > 0, {(hsize_t)count}}),
	              data);
}

void rb_h5_attribute_text(struct rb_h5 *h5, const char *path, const char *name, const char *text)
{
	if (h5->status || h5->there)
		return;
	if (!text)
		text = "";
	const hid_t type = text_type(strlen(text));
	/* plain ASCII where it is: VTK and H5MD ask for it */
	for (const char *c = text;; c++) {
		if (*c == '\0') {
			H5Tset_cset(type, H5T_CSET_ASCII);
			break;
		}
		if ((unsigned char)*c >= 0x80)
			break;
	}
	put_attribute(h5, path, name, (const hid_t[2]){type, type}, H5Screate(H5S_SCALAR), text);
	rb_h5_done(type);
}

void rb_h5_units(struct rb_h5 *h5, const char *path, const char *units)
{
	if (units)
		rb_h5_attribute_text(h5, path, "units", units);
}

void rb_h5_link(struct rb_h5 *h5, const char *path, const char *new_path)
{
	if (h5->status || h5->there)
		return;
	const hid_t links = rb_h5_link_properties();

	if (H5Lcreate_hard(h5->file, path, h5->file, new_path, links, H5P_DEFAULT) < 0)
		rb_h5_fail(h5, "link", new_path);
	rb_h5_done(links);
}

void rb_h5_link_soft(struct rb_h5 *h5, const char *path, const char *new_path)
{
	if (h5->status)
		return;
	const hid_t links = rb_h5_link_properties();

	if (H5Lcreate_soft(path, h5->file, new_path, links, H5P_DEFAULT) < 0)
		rb_h5_fail(h5, "link", new_path);
	rb_h5_done(links);
}

char *rb_h5_escape(const char *name, char *out, size_t size)
{
	size_t at = 0;

	RB_ASSERT(size >= 2);
	for (const char *c = name; *c; c++) {
		const bool special = *c == '/' || *c == '%' || (*c == '.' && c == name);
		if (at + 4 > size)
			break;
		if (special)
			at += (size_t)snprintf(out + at, size - at, "%%%02X",
			                       (unsigned)(unsigned char)*c);
		else
			out[at++] = *c;
	}
	if (at == 0)
		out[at++] = '%';
	out[at] = '\0';
	return out;
}

/* Value of an upper-case hexadecimal digit, -1: it is none. */
static int hex_digit(char c)
{
	return c >= '0' && c <= '9' ? c - '0' : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

void rb_h5_unescape(char *name)
{
	char *out = name;

	for (const char *c = name; *c; c++) {
		if (*c == '%' && hex_digit(c[1]) >= 0 && hex_digit(c[2]) >= 0) {
			*out++ = (char)(hex_digit(c[1]) * 16 + hex_digit(c[2]));
			c += 2;
		} else if (*c != '%' || c[1] != '\0') {
			*out++ = *c;
		}
	}
	*out = '\0';
}
