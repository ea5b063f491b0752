/* SPDX-License-Identifier: MIT */
/*
 * HDF5 was not written for hostile files: it follows links out of the file, loads plugins,
 * allocates what a header says. So everything is checked with calls that read metadata only, before
 * a call that reads data: links part by part, storage, filters, type, shape. A size is bounded by
 * that of the file, times the best ratio of deflate.
 */
#include "sink/h5input.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"

/*
 * PATH_SIZE: of a path within a file. DEFLATE_MOST: the best ratio that deflate can reach (zlib's
 * technical details: 1032:1). LOOKS: how often a file is looked at that a writer is making longer,
 * 5 ms apart. BEING_WRITTEN: the mark of SWMR in the superblock's flags. READ_ATTEMPTS: of metadata
 * that is being changed; after pauses twice as long each time about a minute.
 */
enum {
	PATH_SIZE = 1024,
	SUPERBLOCK_SIZE = 48,
	DEFLATE_MOST = 1032,
	LOOKS = 20,
	BEING_WRITTEN = 4,
	READ_ATTEMPTS = 25
};

/* Eight bytes. */
static uint64_t little_endian(const unsigned char *bytes)
{
	uint64_t value = 0;

	for (int i = 7; i >= 0; i--)
		value = value << 8 | bytes[i];
	return value;
}

void rb_input_look(struct rb_input *input)
{
	struct stat found;

	if (input->fd >= 0 && fstat(input->fd, &found) == 0)
		input->size_bytes = (uint64_t)found.st_size;
}

static bool is_scene(const char *name)
{
	const char *const ending = strrchr(name, '.');

	return ending && strcmp(ending, ".lua") == 0;
}

/*
 * Checks what HDF5 itself does not, or not clearly: that this is a file of its kind and all there.
 * In SWMR mode it reads zeros beyond the end of a file that was cut off.
 */
static enum rb_status check_file(struct rb_input *input, struct rb_error *err)
{
	static const unsigned char signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
	unsigned char head[SUPERBLOCK_SIZE] = {0};

	RB_ASSERT(input->fd >= 0);
	/* A writer that is just making the file longer is waited for. */
	for (int i = 0; i < LOOKS; i++) {
		const ssize_t size = pread(input->fd, head, sizeof head, 0);
		rb_input_look(input);
		if (size < 0)
			return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': %s", input->name,
			               strerror(errno));
		if (size == 0)
			return RB_FAIL(err, RB_ERR_INPUT, "'%s' is empty", input->name);
		if (size < (ssize_t)sizeof signature ||
		    memcmp(head, signature, sizeof signature) != 0)
			return RB_FAIL(err, RB_ERR_INPUT, "'%s' is not an HDF5 file%s", input->name,
			               is_scene(input->name)
			                       ? " (a scene: its run makes a recording)"
			                       : "");
		const bool known = (head[8] == 2 || head[8] == 3) && head[9] == 8 && head[10] == 8;
		if (!known)
			return size < SUPERBLOCK_SIZE
			               ? RB_FAIL(err, RB_ERR_INPUT,
			                         "'%s' is cut off: it has %llu bytes", input->name,
			                         (unsigned long long)input->size_bytes)
			               : RB_OK;
		if (size == SUPERBLOCK_SIZE && input->size_bytes >= little_endian(head + 28))
			return RB_OK;
		if (!(head[11] & BEING_WRITTEN))
			break;
		nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
	}
	return RB_FAIL(err, RB_ERR_INPUT, "'%s' is cut off: %llu of %llu bytes are there",
	               input->name, (unsigned long long)input->size_bytes,
	               (unsigned long long)little_endian(head + 28));
}

/* Whether the file is marked as being written by the rules of SWMR. */
static bool marked_shared(const struct rb_input *input)
{
	unsigned char head[SUPERBLOCK_SIZE];

	return pread(input->fd, head, sizeof head, 0) == SUPERBLOCK_SIZE &&
	       (head[11] & BEING_WRITTEN) != 0;
}

/* Opens the file; input->file is negative where that fails. */
static void open_with(struct rb_input *input, const char *name, unsigned flags, unsigned attempts)
{
	const hid_t access = rb_h5_access(attempts);

	input->file = H5Fopen(name, flags, access);
	rb_h5_done(access);
}

enum rb_status rb_input_open(struct rb_input *input, const char *name, struct rb_error *err)
{
	struct stat found;

	*input = (struct rb_input){.file = -1, .name = name, .fd = -1};
	rb_h5_quiet();
	/* not to wait for the other end of a pipe */
	input->fd = open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (input->fd < 0 || fstat(input->fd, &found) != 0)
		return RB_FAIL(err, RB_ERR_INPUT, "cannot open '%s': %s", name, strerror(errno));
	if (!S_ISREG(found.st_mode))
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': it is %s", name,
		               S_ISDIR(found.st_mode) ? "a folder" : "not a regular file");
	const enum rb_status status = check_file(input, err);
	if (status)
		return status;

	/*
	 * A file that was closed is read as it is; one that grows, or whose writer was killed, by
	 * the rules of SWMR.
	 */
	open_with(input, name, H5F_ACC_RDONLY, 1);
	if (input->file < 0 && marked_shared(input)) {
		/*
		 * What is just being changed is read again, after a pause twice as long each time:
		 * not for ever.
		 */
		open_with(input, name, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, READ_ATTEMPTS);
		input->shared = true;
	}
	if (input->file < 0) {
		const int number = rb_h5_errno();
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': %s", name,
		               number == EAGAIN ? "another program has locked it"
		               : number != 0    ? strerror(number)
		                                : "it is damaged, or no recording that can be read "
		                                  "while it is written");
	}
	return RB_OK;
}

void rb_input_close(struct rb_input *input)
{
	if (input->file >= 0)
		H5Fclose(input->file);
	if (input->fd >= 0)
		close(input->fd);
	input->file = -1;
	input->fd = -1;
}

/* Whether a file of this size cannot hold so many bytes of data. */
static bool too_long(const struct rb_input *input, uint64_t bytes, bool filtered)
{
	return filtered ? bytes / DEFLATE_MOST > input->size_bytes : bytes > input->size_bytes;
}

bool rb_input_has(const struct rb_input *input, const char *path)
{
	char part[PATH_SIZE];
	H5L_info_t info;

	RB_ASSERT(input->file >= 0);
	if (strlen(path) >= sizeof part)
		return false;
	for (const char *end = path; *end;) {
		end++;
		end += strcspn(end, "/");
		snprintf(part, sizeof part, "%.*s", (int)(end - path), path);
		if (H5Lexists(input->file, part, H5P_DEFAULT) <= 0 ||
		    H5Lget_info(input->file, part, &info, H5P_DEFAULT) < 0 ||
		    info.type != H5L_TYPE_HARD)
			return false;
	}
	return true;
}

/* Whether the data are in this file and nowhere else, by filters that are part of every HDF5. */
static bool plain_storage(hid_t dataset, bool *filtered)
{
	const hid_t properties = H5Dget_create_plist(dataset);
	bool plain = properties >= 0;

	*filtered = false;
	if (plain) {
		const H5D_layout_t layout = H5Pget_layout(properties);
		plain = (layout == H5D_COMPACT || layout == H5D_CONTIGUOUS ||
		         layout == H5D_CHUNKED) &&
		        H5Pget_external_count(properties) == 0;
		const int filters = plain && layout == H5D_CHUNKED ? H5Pget_nfilters(properties)
		                                                   : 0;
		for (int i = 0; i < filters && plain; i++) {
			size_t none = 0;
			unsigned flags, config;
			const H5Z_filter_t filter = H5Pget_filter2(properties, (unsigned)i, &flags,
			                                           &none, NULL, 0, NULL, &config);
			plain = filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SHUFFLE ||
			        filter == H5Z_FILTER_FLETCHER32;
			*filtered = true;
		}
		plain = plain && filters >= 0;
	}
	rb_h5_done(properties);
	return plain;
}

/* Whether a chunk, which is unpacked as a whole, can come from a file of this size. */
static bool chunk_fits(const struct rb_input *input, hid_t dataset, size_t element)
{
	const hid_t properties = H5Dget_create_plist(dataset);
	hsize_t size[H5S_MAX_RANK];
	const int rank = H5Pget_layout(properties) == H5D_CHUNKED
	                         ? H5Pget_chunk(properties, H5S_MAX_RANK, size)
	                         : 0;
	uint64_t bytes = element;
	bool fits = true;

	for (int i = 0; i < rank && fits; i++)
		fits = !__builtin_mul_overflow(bytes, size[i], &bytes);
	rb_h5_done(properties);
	return fits && !too_long(input, bytes, true);
}

/*
 * Compares rank and sizes with `row`, of which sizes of 0 are filled in; `*count`: elements. False:
 * it is another shape, or the count overflows.
 */
static bool check_shape(hid_t space, bool grows, rb_h5_shape *row, hsize_t *rows, uint64_t *count)
{
	hsize_t size[H5S_MAX_RANK];
	const int rank = H5Sget_simple_extent_ndims(space);

	RB_ASSERT(row->rank >= 0 && row->rank <= RB_H5_RANK_MAX);
	*count = 1;
	if (rank != row->rank + grows || H5Sget_simple_extent_type(space) == H5S_NULL ||
	    H5Sget_simple_extent_dims(space, size, NULL) < 0)
		return false;
	*rows = rank > 0 ? size[0] : 1;
	for (int i = 0; i < row->rank; i++) {
		const hsize_t is = size[i + grows];
		if (row->size[i] != 0 && row->size[i] != is)
			return false;
		row->size[i] = is;
	}
	for (int i = 0; i < rank; i++)
		if (__builtin_mul_overflow(*count, size[i], count))
			return false;
	return true;
}

static bool is_number(hid_t type)
{
	const H5T_class_t class = H5Tget_class(type);

	return (class == H5T_FLOAT || class == H5T_INTEGER) && H5Tget_size(type) <= 8;
}

static bool is_text(hid_t type)
{
	return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0;
}

/* Opens a dataset of a good type and shape that can be read into memory; -1: it is none. */
static hid_t open_dataset(const struct rb_input *input, const char *path,
                          bool (*is_good)(hid_t type), bool grows, rb_h5_shape *row, hsize_t *rows)
{
	uint64_t count, bytes;
	bool filtered;

	if (!rb_input_has(input, path))
		return -1;
	const hid_t dataset = H5Dopen2(input->file, path, H5P_DEFAULT);
	if (dataset < 0)
		return -1;
	const hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
	const size_t size = H5Tget_size(type);
	const bool good = size > 0 && is_good(type) && plain_storage(dataset, &filtered) &&
	                  check_shape(space, grows, row, rows, &count) &&
	                  !__builtin_mul_overflow(count, size, &bytes) &&
	                  !too_long(input, bytes, filtered) &&
	                  (!filtered || chunk_fits(input, dataset, size));

	rb_h5_done(space);
	rb_h5_done(type);
	if (good)
		return dataset;
	rb_h5_done(dataset);
	return -1;
}

hid_t rb_input_dataset(const struct rb_input *input, const char *path, bool grows, rb_h5_shape *row,
                       hsize_t *rows)
{
	return open_dataset(input, path, is_number, grows, row, rows);
}

bool rb_input_rows(hid_t dataset, enum rb_h5_kind kind, rb_h5_shape row, const hsize_t range[2],
                   void *out)
{
	hsize_t start[RB_H5_RANK_MAX + 1] = {range[0]}, size[RB_H5_RANK_MAX + 1] = {range[1]};

	RB_ASSERT(row.rank >= 0 && row.rank <= RB_H5_RANK_MAX);
	if (range[1] == 0)
		return true;
	for (int i = 0; i < row.rank; i++)
		size[i + 1] = row.size[i];
	const hid_t space = H5Dget_space(dataset);
	const hid_t memory = H5Screate_simple(row.rank + 1, size, NULL);
	const bool read = space >= 0 && memory >= 0 &&
	                  H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, size, NULL) >=
	                          0 &&
	                  H5Sselect_valid(space) > 0 &&
	                  H5Dread(dataset, rb_h5_type(kind), memory, space, H5P_DEFAULT, out) >= 0;

	rb_h5_done(memory);
	rb_h5_done(space);
	return read;
}

bool rb_input_numbers(const struct rb_input *input, const char *path, enum rb_h5_kind kind,
                      rb_h5_shape shape, void *out)
{
	hsize_t rows;
	const hid_t dataset = rb_input_dataset(input, path, false, &shape, &rows);
	const bool read = dataset >= 0 && H5Dread(dataset, rb_h5_type(kind), H5S_ALL, H5S_ALL,
	                                          H5P_DEFAULT, out) >= 0;

	rb_h5_done(dataset);
	return read;
}

/* A dataset of `count` fixed-length texts (0: a scalar), and the length of each; -1: it is none. */
static hid_t text_dataset(const struct rb_input *input, const char *path, size_t count,
                          size_t *room)
{
	rb_h5_shape shape = {count > 0, {count}};
	hsize_t rows;
	const hid_t dataset = open_dataset(input, path, is_text, false, &shape, &rows);

	if (dataset < 0)
		return -1;
	const hid_t type = H5Dget_type(dataset);
	*room = H5Tget_size(type);
	rb_h5_done(type);
	return dataset;
}

/* Reads texts as they are on disk: the type in the file is the type in memory. */
static bool read_text(hid_t dataset, char *out)
{
	const hid_t type = H5Dget_type(dataset);
	const bool read = type >= 0 &&
	                  H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out) >= 0;

	rb_h5_done(type);
	return read;
}

/* Zeroed memory of the arena; NULL: out of memory. */
static void *take_zeroed(struct rb_arena *arena, size_t count, size_t size)
{
	void *const block = rb_arena_take(arena, count, size);

	if (block)
		memset(block, 0, count * size);
	return block;
}

char *rb_input_text(const struct rb_input *input, const char *path, struct rb_arena *arena,
                    size_t *room)
{
	size_t size = 0;
	const hid_t dataset = text_dataset(input, path, 0, &size);
	char *text = dataset < 0 ? NULL : take_zeroed(arena, size + 1, 1);

	if (text && !read_text(dataset, text))
		text = NULL;
	if (text)
		text[size] = '\0';
	rb_h5_done(dataset);
	if (room)
		*room = size;
	return text;
}

enum rb_status rb_input_no_text(const struct rb_input *input, const char *path, const char *name,
                                struct rb_error *err)
{
	size_t size = 0;
	const hid_t dataset = text_dataset(input, path, 0, &size);

	rb_h5_done(dataset);
	if (dataset >= 0) {
		/* bytes that cannot be read are damage, of any size that there is memory for */
		void *const block = size < SIZE_MAX ? rb_memory_take(size + 1, 1) : NULL;
		const bool damaged = block != NULL;

		rb_memory_free(block);
		return damaged ? RB_FAIL(err, RB_ERR_INPUT, "'%s' is damaged: cannot read '%s'",
		                         name, path)
		               : RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory",
		                         name);
	}
	return RB_FAIL(err, RB_ERR_INPUT,
	               "'%s' is not a recording of rbsim: '%s' is missing or no text", name, path);
}

char *rb_input_bytes(const struct rb_input *input, const char *path, struct rb_arena *arena,
                     size_t *size)
{
	rb_h5_shape shape = {1, {0}};
	hsize_t rows = 0;
	const hid_t dataset = rb_input_dataset(input, path, false, &shape, &rows);
	const hid_t type = dataset < 0 ? -1 : H5Dget_type(dataset);
	const bool bytes = type >= 0 && H5Tequal(type, rb_h5_type_file(RB_H5_U8)) > 0;
	char *text = bytes && rows < SIZE_MAX ? take_zeroed(arena, (size_t)rows + 1, 1) : NULL;

	if (text && rows > 0 &&
	    H5Dread(dataset, rb_h5_type(RB_H5_U8), H5S_ALL, H5S_ALL, H5P_DEFAULT, text) < 0)
		text = NULL;
	*size = text ? (size_t)rows : 0;
	rb_h5_done(type);
	rb_h5_done(dataset);
	return text;
}

bool rb_input_text_again(const struct rb_input *input, const char *path, char *text, size_t room)
{
	size_t size = 0;
	const hid_t dataset = text_dataset(input, path, 0, &size);
	const bool read = dataset >= 0 && size == room && read_text(dataset, text);

	text[room] = '\0';
	rb_h5_done(dataset);
	return read;
}

const char **rb_input_texts(const struct rb_input *input, const char *path, size_t count,
                            struct rb_arena *arena)
{
	size_t room = 0;
	const char **const texts = take_zeroed(arena, count + 1, sizeof *texts);
	const hid_t dataset = !texts || count == 0 ? -1 : text_dataset(input, path, count, &room);
	char *const cells = dataset < 0 ? NULL : rb_arena_take(arena, count, room);
	char *const copies = dataset < 0 ? NULL : take_zeroed(arena, count, room + 1);
	const bool read = cells && copies && read_text(dataset, cells);

	for (size_t i = 0; texts && i < count; i++) {
		texts[i] = read ? copies + i * (room + 1) : "";
		if (read)
			memcpy(copies + i * (room + 1), cells + i * room, room);
	}
	rb_h5_done(dataset);
	return texts;
}

char *rb_input_attribute(const struct rb_input *input, const char *path, const char *name,
                         struct rb_arena *arena)
{
	const hid_t object = rb_input_has(input, path) ? H5Oopen(input->file, path, H5P_DEFAULT)
	                                               : -1;
	const hid_t attribute = object >= 0 && H5Aexists(object, name) > 0
	                                ? H5Aopen(object, name, H5P_DEFAULT)
	                                : -1;
	const hid_t type = attribute < 0 ? -1 : H5Aget_type(attribute);
	const hid_t space = attribute < 0 ? -1 : H5Aget_space(attribute);
	char *text = NULL;

	if (type >= 0 && space >= 0 && H5Tget_class(type) == H5T_STRING &&
	    H5Tis_variable_str(type) == 0 && H5Sget_simple_extent_npoints(space) == 1 &&
	    !too_long(input, H5Tget_size(type), false)) {
		text = take_zeroed(arena, H5Tget_size(type) + 1, 1);
		if (text && H5Aread(attribute, type, text) < 0)
			text = NULL;
	}
	rb_h5_done(space);
	rb_h5_done(type);
	rb_h5_done(attribute);
	rb_h5_done(object);
	return text;
}

int rb_input_members(const struct rb_input *input, const char *path, int most, const char ***names,
                     struct rb_arena *arena)
{
	H5G_info_t info;
	int count = 0;

	RB_ASSERT(most >= 0);
	*names = NULL;
	const hid_t group = rb_input_has(input, path) ? H5Gopen2(input->file, path, H5P_DEFAULT)
	                                              : -1;
	if (group < 0 || H5Gget_info(group, &info) < 0) {
		rb_h5_done(group);
		return 0;
	}
	const hsize_t links = info.nlinks < (hsize_t)most ? info.nlinks : (hsize_t)most;
	*names = take_zeroed(arena, (size_t)links + 1, sizeof **names);
	for (hsize_t i = 0; *names && i < links; i++) {
		char name[PATH_SIZE / 2];
		ssize_t size = H5Lget_name_by_idx(group, ".", H5_INDEX_CRT_ORDER, H5_ITER_INC, i,
		                                  name, sizeof name, H5P_DEFAULT);
		if (size < 0)
			size = H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name,
			                          sizeof name, H5P_DEFAULT);
		if (size <= 0 || size >= (ssize_t)sizeof name)
			continue;
		char *const copy = take_zeroed(arena, (size_t)size + 1, 1);
		if (!copy)
			break;
		memcpy(copy, name, (size_t)size);
		(*names)[count++] = copy;
	}
	rb_h5_done(group);
	return count;
}

int rb_input_row_count(const struct rb_input *input, const char *path)
{
	rb_h5_shape shape = {1, {0}};
	hsize_t rows = 0;

	if (!rb_input_has(input, path))
		return 0;
	const hid_t dataset = rb_input_dataset(input, path, false, &shape, &rows);
	rb_h5_done(dataset);
	return dataset < 0 || rows > INT32_MAX ? 0 : (int)rows;
}
