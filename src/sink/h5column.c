/* SPDX-License-Identifier: MIT */
/*
 * The library's chunk cache is turned off for columns without a filter (size 0): each append then
 * goes straight to its place in the file by one write. With a filter it cannot: a chunk is packed
 * as a whole, so the cache must hold the chunks of all pieces of a row, and one.
 *
 * A frame of many bodies is split among several chunks along the bodies (`pieces`), because a chunk
 * has a limit of 4 GiB and is the unit of reading.
 */
#include "sink/h5column.h"

#include "base/error.h"

/* Chunks that one row goes to. */
static hsize_t pieces(const struct rb_h5_layout *layout)
{
	if (layout->row.rank == 0 || layout->chunk_first == 0 || layout->row.size[0] == 0)
		return 1;
	return (layout->row.size[0] + layout->chunk_first - 1) / layout->chunk_first;
}

uint64_t rb_h5_column_plain(const struct rb_h5_column *column, hsize_t rows)
{
	const struct rb_h5_layout *const layout = &column->layout;
	uint64_t bytes = rows * rb_h5_size(layout->kind);

	for (int i = 0; i < layout->row.rank; i++)
		bytes *= layout->row.size[i];
	return bytes;
}

/* Bytes of a whole chunk without a filter. */
static uint64_t chunk_bytes(const struct rb_h5_layout *layout)
{
	uint64_t bytes = layout->chunk_rows * rb_h5_size(layout->kind);

	RB_ASSERT(layout->chunk_rows > 0);
	for (int i = 0; i < layout->row.rank; i++)
		bytes *= i == 0 && layout->chunk_first > 0 ? layout->chunk_first
		                                           : layout->row.size[i];
	return bytes;
}

/*
 * Sets chunks and filters. Deflate with shuffle: the bytes of doubles that change little in time
 * then form long runs.
 */
static void set_creation(const struct rb_h5_layout *layout, hid_t creation)
{
	hsize_t chunk[RB_H5_RANK_MAX] = {layout->chunk_rows};

	for (int i = 0; i < layout->row.rank; i++)
		chunk[i + 1] = i == 0 && layout->chunk_first > 0 ? layout->chunk_first
		                                                 : layout->row.size[i];
	H5Pset_chunk(creation, layout->row.rank + 1, chunk);
	if (layout->compression > 0) {
		H5Pset_shuffle(creation);
		H5Pset_deflate(creation, (unsigned)layout->compression);
	} else {
		/*
		 * never filled and too large for a cache of nothing: written straight to the file
		 */
		H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
	}
}

/*
 * A cache for chunks with a filter only; 101 slots for each chunk keep its hash table without
 * collisions, as the library's manual advises.
 */
static hid_t access_properties(const struct rb_h5_layout *layout)
{
	const size_t count = pieces(layout);

	if (layout->compression == 0)
		return rb_h5_uncached_properties();
	const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
	H5Pset_chunk_cache(access, 101 * count + 1, (count + 1) * chunk_bytes(layout) + 1, 1.0);
	return access;
}

/*
 * Opens the dataset that is there; it must be the one that would be made, of any length. `size`: of
 * a row, from [1] on.
 */
static void reopen(struct rb_h5 *h5, struct rb_h5_column *column, const hsize_t *size)
{
	hsize_t found[RB_H5_RANK_MAX] = {0};
	const int rank = column->layout.row.rank + 1;

	rb_h5_column_attach(h5, column);
	const hid_t space = column->dataset < 0 ? -1 : H5Dget_space(column->dataset);
	const hid_t type = column->dataset < 0 ? -1 : H5Dget_type(column->dataset);
	bool same = space >= 0 && H5Sget_simple_extent_ndims(space) == rank &&
	            H5Sget_simple_extent_dims(space, found, NULL) == rank && type >= 0 &&
	            H5Tequal(type, rb_h5_type_file(column->layout.kind)) > 0;
	for (int i = 1; same && i < rank; i++)
		same = found[i] == size[i];
	column->there = same ? found[0] : 0;
	if (!same && !h5->status)
		h5->status = RB_FAIL(&h5->error, RB_ERR_INPUT,
		                     "'%s' in '%s' is not what this run would record", column->path,
		                     h5->name);
	rb_h5_done(type);
	rb_h5_done(space);
}

void rb_h5_column_create(struct rb_h5 *h5, struct rb_h5_column *column, const char *path,
                         const struct rb_h5_layout *layout)
{
	hsize_t size[RB_H5_RANK_MAX] = {0}, most[RB_H5_RANK_MAX] = {H5S_UNLIMITED};

	RB_ASSERT(layout->row.rank < RB_H5_RANK_MAX && layout->chunk_rows > 0);
	*column = (struct rb_h5_column){
		.dataset = -1, .type = rb_h5_type(layout->kind), .layout = *layout, .path = path};
	column->row_bytes = rb_h5_size(layout->kind);
	for (int i = 0; i < layout->row.rank; i++) {
		size[i + 1] = most[i + 1] = layout->row.size[i];
		column->row_bytes *= layout->row.size[i];
	}
	if (h5->status)
		return;
	if (h5->there) {
		reopen(h5, column, size);
		return;
	}

	const hid_t creation = rb_h5_dataset_properties();
	const hid_t access = access_properties(layout);
	const hid_t links = rb_h5_link_properties();
	const hid_t space = H5Screate_simple(layout->row.rank + 1, size, most);
	set_creation(layout, creation);
	column->dataset = H5Dcreate2(h5->file, path, rb_h5_type_file(layout->kind), space, links,
	                             creation, access);
	if (column->dataset < 0)
		rb_h5_fail(h5, "make", path);
	rb_h5_made(h5, path, column->dataset);
	rb_h5_done(space);
	rb_h5_done(links);
	rb_h5_done(access);
	rb_h5_done(creation);
}

void rb_h5_column_detach(struct rb_h5_column *column)
{
	rb_h5_done(column->dataset);
	column->dataset = -1;
}

void rb_h5_column_attach(struct rb_h5 *h5, struct rb_h5_column *column)
{
	if (h5->status)
		return;
	const hid_t access = access_properties(&column->layout);

	column->dataset = H5Dopen2(h5->file, column->path, access);
	if (column->dataset < 0)
		rb_h5_fail(h5, "open", column->path);
	rb_h5_done(access);
}

/* Makes the dataset at least `rows` long; a longer one is never cut. False: the library failed. */
static bool grow(struct rb_h5_column *column, hsize_t rows)
{
	const struct rb_h5_layout *const layout = &column->layout;
	hsize_t size[RB_H5_RANK_MAX] = {rows};

	if (rows <= column->there)
		return true;
	for (int i = 0; i < layout->row.rank; i++)
		size[i + 1] = layout->row.size[i];
	return H5Dset_extent(column->dataset, size) >= 0;
}

void rb_h5_column_append(struct rb_h5 *h5, struct rb_h5_column *column, hsize_t count,
                         const void *data)
{
	const struct rb_h5_layout *const layout = &column->layout;
	hsize_t start[RB_H5_RANK_MAX] = {column->rows}, size[RB_H5_RANK_MAX] = {count};

	RB_ASSERT(h5->status || count == 0 || data);
	if (h5->status || count == 0)
		return;
	for (int i = 0; i < layout->row.rank; i++)
		size[i + 1] = layout->row.size[i];

	bool failed = !grow(column, column->rows + count);
	const hid_t space = failed ? -1 : H5Dget_space(column->dataset);
	const hid_t memory = H5Screate_simple(layout->row.rank + 1, size, NULL);
	failed = failed || space < 0 ||
	         H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, size, NULL) < 0 ||
	         H5Dwrite(column->dataset, column->type, memory, space, H5P_DEFAULT, data) < 0;
	if (failed)
		rb_h5_fail(h5, "write", column->path);
	else
		column->rows += count;
	rb_h5_done(memory);
	rb_h5_done(space);
}

void rb_h5_column_extend(struct rb_h5 *h5, struct rb_h5_column *column, hsize_t count)
{
	if (h5->status)
		return;
	if (!grow(column, column->rows + count))
		rb_h5_fail(h5, "extend", column->path);
	column->rows += count;
}

void rb_h5_column_close(struct rb_h5_column *column)
{
	if (column->path)
		rb_h5_done(column->dataset);
	*column = (struct rb_h5_column){.dataset = -1};
}

/* Chunks of `rows` rows. */
static uint64_t chunk_count(const struct rb_h5_column *column, hsize_t rows)
{
	const hsize_t along = (rows + column->layout.chunk_rows - 1) / column->layout.chunk_rows;

	return along * pieces(&column->layout);
}

uint64_t rb_h5_column_need(const struct rb_h5_column *column, hsize_t count)
{
	/*
	 * A chunk with a filter is written anew when rows are added to it, and the old one's space
	 * is not used again.
	 */
	const hsize_t before = column->layout.compression > 0
	                               ? column->rows / column->layout.chunk_rows *
	                                         pieces(&column->layout)
	                               : chunk_count(column, column->rows);
	uint64_t chunks = chunk_count(column, column->rows + count) - before;
	if (column->layout.compression == 0) {
		const uint64_t there = chunk_count(column, column->there);
		const uint64_t after = chunk_count(column, column->rows + count);

		chunks = after > there ? (after - there < chunks ? after - there : chunks) : 0;
	}

	/*
	 * The index: 8 or 16 bytes a chunk, given out in blocks that grow with the root of their
	 * number.
	 */
	/* the root: blocks of the extensible array double as it grows */
	uint64_t block = 512;
	while (block * block / 256 < chunk_count(column, column->rows + count))
		block *= 2;
	return chunks * chunk_bytes(&column->layout) +
	       (chunks > 0 ? 32 * chunks + 4 * block + 8192 : 0);
}

uint64_t rb_h5_column_bytes(const struct rb_h5_column *column, hsize_t rows)
{
	const uint64_t chunks = chunk_count(column, rows);

	/*
	 * the index: a header and blocks of addresses, each with room after it
	 * (rb_frames_alignment)
	 */
	RB_ASSERT(column->layout.chunk_rows > 0);
	return chunks * chunk_bytes(&column->layout) + 10 * chunks + 1360;
}
