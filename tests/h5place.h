/* SPDX-License-Identifier: MIT */
/* An HDF5 file in a folder of its own, for the tests of what writes into one. */
#ifndef RB_TESTS_H5PLACE_H
#define RB_TESTS_H5PLACE_H

#include "support.h"

#include "sink/h5file.h"

/* A file in a folder of its own. */
struct file {
	char folder[256], path[300];
	struct rb_h5 h5;
};

static inline void open_file(struct file *file)
{
	*file = (struct file){.h5 = {.name = "f.h5"}};
	rb_h5_quiet();
	support_folder(file->folder);
	snprintf(file->path, sizeof file->path, "%s/f.h5", file->folder);
	const hid_t access = rb_h5_access(1);
	file->h5.file = H5Fcreate(file->path, H5F_ACC_EXCL, H5P_DEFAULT, access);
	assert_true(file->h5.file >= 0);
	rb_h5_done(access);
}

/* Closed and opened again. */
static inline void turn_file(struct file *file, unsigned flags)
{
	if (file->h5.status)
		fail_msg("%s", file->h5.error.text);
	/* nothing else may be open in it: it would keep the file */
	assert_int_equal(H5Fget_obj_count(file->h5.file, H5F_OBJ_ALL), 1);
	assert_true(H5Fclose(file->h5.file) >= 0);
	const hid_t access = rb_h5_access(1);
	file->h5.file = H5Fopen(file->path, flags, access);
	assert_true(file->h5.file >= 0);
	rb_h5_done(access);
}

static inline void close_file(struct file *file)
{
	assert_true(H5Fclose(file->h5.file) >= 0);
	assert_int_equal(unlink(file->path), 0);
	assert_int_equal(rmdir(file->folder), 0);
}

#endif
