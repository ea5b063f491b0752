/* SPDX-License-Identifier: MIT */
#include "sink/h5estimate.h"

#include <stdio.h>

#include "base/memory.h"
#include "sink/h5about.h"
#include "sink/h5compact.h"
#include "sink/h5frames.h"
#include "sink/h5vtk.h"

/* A file in memory, for estimates. */
static hid_t memory_file(unsigned alignment)
{
	const hid_t access = rb_h5_access_aligned(alignment);
	char name[64];

	H5Pset_fapl_core(access, 1 << 16, 0);
	/* names that no file can have, so that none is looked at, and two, so that these are two */
	snprintf(name, sizeof name, "/dev/null/estimate-%u", alignment);
	const hid_t file = rb_h5_create(name, access);
	rb_h5_done(access);
	return file;
}

/* Its size, that of its image, for the file itself goes by whole blocks; 0: a failure. */
static uint64_t memory_size(hid_t file)
{
	const ssize_t size = H5Fflush(file, H5F_SCOPE_LOCAL) < 0 ? -1
	                                                         : H5Fget_file_image(file, NULL, 0);

	return size < 0 ? 0 : (uint64_t)size;
}

/* Its size after compaction; 0: a failure. */
static uint64_t compact_size(hid_t file)
{
	unsigned char *image;
	size_t size;

	if (rb_compact_image(file, "estimate", NULL, &image, &size, NULL))
		return 0;
	rb_memory_free(image);
	return size;
}

/* Adds /VTKHDF without the points of surfaces; the bytes that these take. */
static uint64_t pretend_vtk(struct rb_h5 *h5, const struct rb_run_info *info,
                            const struct rb_frames *frames, uint64_t rows)
{
	struct rb_vtk vtk = rb_vtk_of(info, frames, rows);

	vtk.fields |= info->scene->record.fields & RB_FIELD_SURFACES;
	vtk.pretend = true;
	if (!h5->status)
		h5->status = rb_vtk_begin(&vtk, &h5->error);
	rb_vtk_write(h5, &vtk);
	const uint64_t points = vtk.surfaces.moving.point_count;
	rb_vtk_release(&vtk);
	return 12 * rows * points;
}

/*
 * Both parts of the file are made in memory as they will be, but for the rows: these take what
 * their chunks take.
 */
uint64_t rb_h5_estimate(const struct rb_run_info *info)
{
	struct rb_h5 about = {.name = "estimate"}, growing = about;
	struct rb_frames frames;
	uint64_t size = 0;

	rb_h5_quiet();
	about.file = memory_file(1);
	growing.file = memory_file(rb_frames_alignment(info));
	if (about.file >= 0 && growing.file >= 0) {
		rb_about_write(&about, info);
		const uint64_t expected = rb_frames_expected(info);
		rb_about_write_changing(&growing, info->scene);
		rb_frames_create(&growing, &frames, info);
		const uint64_t rows = rb_frames_pretend(&growing, &frames, expected);
		const uint64_t plain = rb_frames_plain(&frames, expected);
		const uint64_t view = frames.time ? pretend_vtk(&growing, info, &frames, expected)
		                                  : 0;
		rb_frames_release(&frames);
		const uint64_t fixed = memory_size(about.file), moving = memory_size(growing.file);
		size = about.status || growing.status || fixed == 0 || moving == 0
		               ? 0
		               : fixed + moving + rows + view;
		if (size > 0 && size <= RB_COMPACT_MOST)
			size = compact_size(about.file) + compact_size(growing.file) + plain + view;
	}
	rb_h5_done(about.file);
	rb_h5_done(growing.file);
	return size;
}
