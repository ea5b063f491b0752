/* SPDX-License-Identifier: MIT */
/*
 * /VTKHDF: the recording as VTK's readers want it, for ParaView and others. The large columns are
 * virtual datasets over those of the recording, and contacts are the table itself: not a byte of
 * them is copied. PolyData in time (VTKHDF 2.0, VTK 9.3): a vertex for each body. Where there are
 * contacts or surfaces a collection of such (2.1, VTK 9.4): bodies, surfaces, statics, contacts.
 */
#ifndef RB_SINK_H5VTK_H
#define RB_SINK_H5VTK_H

#include "flow/run_info.h"
#include "sink/h5frames.h"
#include "sink/h5surfaces.h"

struct rb_vtk {
	/* set by the caller; borrowed */
	const struct rb_model *model;
	const char *time; /* path of the times of frames */
	unsigned fields;  /* stored per frame; RB_FIELD_SURFACES: surfaces are made */
	uint64_t frames;
	bool pretend; /* for estimates: what rb_surfaces_bytes counts is not written */

	/* made by rb_vtk_begin */
	struct rb_surfaces surfaces;
};

/* Of a recording's first `rows` frames, without surfaces. */
struct rb_vtk rb_vtk_of(const struct rb_run_info *info, const struct rb_frames *frames,
                        uint64_t rows);

/* Makes the surfaces that are asked for. Released in any case. RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_vtk_begin(struct rb_vtk *vtk, struct rb_error *err);
void rb_vtk_release(struct rb_vtk *vtk); /* safe on a zeroed one */

/* Most bytes that the group takes. */
uint64_t rb_vtk_need(const struct rb_vtk *vtk);

/*
 * Adds the group. The file must not be in SWMR mode. Nothing is made without positions, bodies or
 * frames.
 */
void rb_vtk_write(struct rb_h5 *h5, struct rb_vtk *vtk);

#endif
