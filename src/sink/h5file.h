/* SPDX-License-Identifier: MIT */
/*
 * Making objects in an HDF5 file, with checked errors.
 *
 * A `struct rb_h5` is a file that is being made, owned by one thread. The first failure sticks:
 * what follows does nothing, so that a list of calls needs one check at its end. Paths are
 * absolute; groups on the way are made.
 */
#ifndef RB_SINK_H5FILE_H
#define RB_SINK_H5FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <hdf5.h>

#include <rbsim/error.h>

struct rb_h5 {
	hid_t file;       /* owned by whoever opened it */
	const char *name; /* of the file, for messages; borrowed */
	bool there;       /* all objects are: columns are opened, attributes and links left alone */
	/* told of every dataset that rb_h5_put... and columns make, still open; NULL: nobody */
	void (*made)(void *user, struct rb_h5 *h5, const char *path, hid_t dataset);
	void *user;
	enum rb_status status;
	struct rb_error error; /* valid if status */
};

/* Numbers in memory and on disk (always little-endian there). */
enum rb_h5_kind {
	RB_H5_F64,
	RB_H5_F32,
	RB_H5_I64,
	RB_H5_U64,
	RB_H5_I32,
	RB_H5_I8,
	RB_H5_U8,
	RB_H5_KIND_COUNT
};
hid_t rb_h5_type(enum rb_h5_kind kind);      /* in memory; the library's, not to be closed */
hid_t rb_h5_type_file(enum rb_h5_kind kind); /* on disk; the library's */
size_t rb_h5_size(enum rb_h5_kind kind);

enum { RB_H5_RANK_MAX = 4 };
typedef struct {
	int rank; /* 0: a scalar */
	hsize_t size[RB_H5_RANK_MAX];
} rb_h5_shape;

/*
 * To be called first on every thread that uses HDF5: no messages of the library's own, no clean-up
 * of its own at exit (after a failed write it could hang), no plugins.
 */
void rb_h5_quiet(void);
/*
 * How files are opened and made; every one is. What other HDF5 from 1.10 on can read, and
 * `attempts` at bytes that are damaged: 1 where nobody else writes them. Left to itself the library
 * tries a hundred times where it writes by the rules of SWMR, after pauses twice as long each time:
 * for ever.
 */
hid_t rb_h5_access(unsigned attempts);

/* The same with objects at multiples of `alignment`, as recordings are made; 1: none. */
hid_t rb_h5_access_aligned(unsigned alignment);
/* Makes a file; negative: failed. The root has room for links that are added when it is closed. */
hid_t rb_h5_create(const char *path, hid_t access);

/* Closes any kind of id; nothing for a negative one. */
void rb_h5_done(hid_t id);

/*
 * What the library says of its last failure on this thread: the system's text where there is one.
 */
const char *rb_h5_reason(char out[160]);
/* The system's number of that failure, 0: none. */
int rb_h5_errno(void);

/* Records a failure `what` of 'path' with the reason, unless one stands already. */
void rb_h5_fail(struct rb_h5 *h5, const char *what, const char *path);

/* Tells who wants to know of a dataset that has been made. */
void rb_h5_made(struct rb_h5 *h5, const char *path, hid_t dataset);

void rb_h5_group(struct rb_h5 *h5, const char *path);
/* A group whose members keep the order in which they were made. */
void rb_h5_group_ordered(struct rb_h5 *h5, const char *path);
void rb_h5_put(struct rb_h5 *h5, const char *path, enum rb_h5_kind kind, rb_h5_shape shape,
               const void *data);
void rb_h5_put_f64(struct rb_h5 *h5, const char *path, double value);
void rb_h5_put_i64(struct rb_h5 *h5, const char *path, int64_t value);
/* UTF-8 of fixed length; NULL is "". `room` >= size when the text may change later. */
void rb_h5_text(struct rb_h5 *h5, const char *path, const char *text, size_t room);
void rb_h5_text_sized(struct rb_h5 *h5, const char *path, const char *text, size_t size);
/* `count` texts of one fixed length, that of the longest. */
void rb_h5_texts(struct rb_h5 *h5, const char *path, const char *const *texts, size_t count);
enum { RB_H5_RETEXT_MAX = 512 };
/*
 * Overwrites a text made with room (RB_H5_RETEXT_MAX at most); longer ones are cut between
 * characters. Works while others read.
 */
void rb_h5_retext(struct rb_h5 *h5, const char *path, const char *text);
/* Overwrites a scalar of that type. Works while others read. */
void rb_h5_rewrite_f64(struct rb_h5 *h5, const char *path, double value);

/* Attributes of the object at `path`. */
void rb_h5_attribute(struct rb_h5 *h5, const char *path, const char *name, enum rb_h5_kind kind,
                     int count, const void *data); /* count 0: a scalar */
void rb_h5_attribute_text(struct rb_h5 *h5, const char *path, const char *name, const char *text);
void rb_h5_units(struct rb_h5 *h5, const char *path, const char *units);

/*
 * Another name for an object: a hard link, counted in its header, and a soft one, which names its
 * path.
 */
void rb_h5_link(struct rb_h5 *h5, const char *path, const char *new_path);
void rb_h5_link_soft(struct rb_h5 *h5, const char *path, const char *new_path);

/*
 * `name` as the last part of a path: what a link's name cannot hold becomes %2F, %2E, %25. Cut at
 * `size`.
 */
char *rb_h5_escape(const char *name, char *out, size_t size);
void rb_h5_unescape(char *name);

/* How datasets of ours are made: no times of making, so that equal runs give equal bytes. */
hid_t rb_h5_dataset_properties(void);
/* Where they are linked: groups on the way are made. */
hid_t rb_h5_link_properties(void); /* not to be changed, as the next */
/* How datasets are opened whose chunks are not cached. */
hid_t rb_h5_uncached_properties(void);

#endif
