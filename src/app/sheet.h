/* SPDX-License-Identifier: MIT */
/*
 * A contact sheet: pictures of a camera, or of a film of several, at even steps through a
 * recording, with their times, in one PNG.
 */
#ifndef RB_APP_SHEET_H
#define RB_APP_SHEET_H

#include "app/common.h"
#include "sink/module.h"

struct rb_sheet {
	struct rb_loaded *loaded;
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	const struct rb_camera_def *camera; /* with from_s and to_s within the recording */
	const struct rb_film_cell *cells;   /* [cell_count] of a film, which `camera` is then */
	int cell_count;                     /* 0: it is one camera */
	const char *path;
	bool replace;
};

/* RB_ERR_CREATE before anything is drawn where `path` is taken. `*bytes`: size of the file. */
RB_CHECKED enum rb_status rb_sheet_make(const struct rb_sheet *sheet, size_t *bytes,
                                        struct rb_error *err);

#endif
