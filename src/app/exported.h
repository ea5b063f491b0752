/* SPDX-License-Identifier: MIT */
/*
 * A recording on its way to another program: its reader, its scene loaded again, where its bodies
 * are, and the files that are made. Main thread.
 */
#ifndef RB_APP_EXPORTED_H
#define RB_APP_EXPORTED_H

#include "app/common.h"
#include "flow/trimesh.h"
#include "base/outfile.h"
#include "sink/module.h"

enum { RB_EXPORTS_MAX = 8, RB_EXPORT_NAME_SIZE = 512 };

/* What an output holds: so many of what it has a row or a picture of. */
struct rb_export_content {
	uint64_t count;
	const char *one, *many; /* "frame", "frames" */
};

struct rb_export_output {
	char name[RB_EXPORT_NAME_SIZE];
	struct rb_export_content content;
};

struct rb_exported {
	const struct rb_options *options;
	const char *file; /* the recording */
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	const struct rb_reading *reading;
	struct rb_loaded loaded;   /* its scene and model; zeroed where the form needs none */
	struct rb_trimesh_box box; /* round all bodies but planes, in all frames */

	/* made so far, for the report */
	struct rb_export_output outputs[RB_EXPORTS_MAX];
	int output_count;
};

/* One form: its name, its usual ending, and what writes it. */
struct rb_export_form {
	const char *name;
	const char *ending;
	enum rb_status (*write)(struct rb_exported *exported, const char *name,
	                        struct rb_error *err);
	bool moves; /* it needs positions and the scene */
};
extern const struct rb_export_form rb_export_csv, rb_export_dump, rb_export_vtk, rb_export_glb;

/* Opens the recording. Released with rb_exported_release in any case. */
RB_CHECKED enum rb_status rb_exported_open(struct rb_exported *exported,
                                           const struct rb_options *options,
                                           const struct rb_export_form *form, struct rb_error *err);
void rb_exported_release(struct rb_exported *exported);

/* Begins an output; published with rb_exported_publish, or released. */
RB_CHECKED enum rb_status rb_exported_begin(const struct rb_exported *exported,
                                            struct rb_outfile *out, const char *name,
                                            struct rb_error *err);
/* `content`: NULL where it is none of the outputs that are named. */
RB_CHECKED enum rb_status rb_exported_publish(struct rb_exported *exported, struct rb_outfile *out,
                                              const char *name,
                                              const struct rb_export_content *content,
                                              struct rb_error *err);

/* Pose of a body by index, moving ones at a frame, others where they stay. */
rb_vec3 rb_exported_position(const struct rb_exported *exported, const struct rb_frame *frame,
                             int index);
rb_quat rb_exported_orientation(const struct rb_exported *exported, const struct rb_frame *frame,
                                int index);

/* How much of an infinite plane is shown: what is below all bodies, and as much around them. */
struct rb_trimesh_patch rb_exported_patch(const struct rb_exported *exported, int index);

/* The shortest of 15, 16 or 17 significant digits that reads back as the same double; "nan". */
void rb_exported_number(FILE *file, double value);

#endif
