# SPDX-License-Identifier: MIT
# A sink of tools/sample: a line of numbers for every frame.
most=4

add()
{
	cat >src/sink/track.h <<'END'
/* SPDX-License-Identifier: MIT */
/*
 * Time and kinetic energy of every frame, a line each, in a file that has its name when it is
 * whole. Lossless; owned by whoever made it, and destroyed after the sink has been closed.
 */
#ifndef RB_SINK_TRACK_H
#define RB_SINK_TRACK_H

#include <rbsim/sink.h>

struct rb_track;

RB_CHECKED enum rb_status rb_track_create(struct rb_track **track, struct rb_sink *sink,
                                          const char *path, struct rb_error *err);
void rb_track_destroy(struct rb_track *track); /* NULL is fine */

#endif
END
	cat >src/sink/track.c <<'END'
/* SPDX-License-Identifier: MIT */
#include "sink/track.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"

struct rb_track {
	const char *path; /* borrowed */
	struct rb_outfile out;
};

static enum rb_status open_file(void *self, struct rb_error *err)
{
	struct rb_track *const track = self;

	return rb_outfile_open(&track->out, track->path, false, err);
}

static enum rb_status frame(void *self, const struct rb_frame *frame, struct rb_error *err)
{
	struct rb_track *const track = self;

	if (fprintf(track->out.file, "%.17g %.17g\n", frame->time_s, frame->numbers.kinetic_energy) < 0)
		return RB_FAIL(err, RB_ERR_IO, "cannot write '%s'", track->path);
	return RB_OK;
}

static enum rb_status close_file(void *self, const struct rb_outcome *outcome, struct rb_error *err)
{
	struct rb_track *const track = self;

	return outcome->status == RB_OK ? rb_outfile_publish(&track->out, err) : RB_OK;
}

enum rb_status rb_track_create(struct rb_track **made, struct rb_sink *sink, const char *path,
                               struct rb_error *err)
{
	struct rb_track *const track = rb_memory_take(1, sizeof *track);

	*made = track;
	if (!track)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for '%s'", path);
	track->path = path;
	*sink = (struct rb_sink){.name = "track",
	                         .lossless = true,
	                         .self = track,
	                         .open = open_file,
	                         .frame = frame,
	                         .close = close_file};
	return RB_OK;
}

void rb_track_destroy(struct rb_track *track)
{
	if (track)
		rb_outfile_release(&track->out);
	rb_memory_free(track);
}
END
	edit src/app/options.h 's|^	const char \*listen, \*commands; .*|&\n	const char *track; /* run; NULL: not given */|'
	edit src/app/options.c 's|^	{"listen", 0, |	{"track", 0, "FILE", RB_OPTION_TEXT, AT(track), VERB(RUN), 0, 0, false, NULL, "write time and kinetic energy of every frame to FILE"},\n&|'
	edit src/app/simulate.c 's|^#include "sink/module.h"|&\n#include "sink/track.h"|' \
		's|^	struct rb_pump \*pump;|&\n	struct rb_track *track; /* NULL: none */\n	struct rb_pump *track_pump;|' \
		's/^	if (!status && (run->recorder || run->films))$/	if (!status \&\& (run->recorder || run->films || run->options->track))/' \
		's|^		status = start_recording(run, err);|&\n	if (!status \&\& run->options->track)\n		status = start_track(run, err);|' \
		's|^	return rb_pump_join(run->pump, err);|	return join_both(run, err);|' \
		'/^\/\* Ends films and recording, in this order/i\
static enum rb_status join_both(struct run *run, struct rb_error *err)\
{\
	struct rb_error own;\
	const enum rb_status status = rb_pump_join(run->pump, err);\
	const enum rb_status tracked = rb_pump_join(run->track_pump, status ? \&own : err);\
\
	rb_track_destroy(run->track);\
	return status ? status : tracked;\
}\
' '/^static enum rb_status start_recording/i\
static enum rb_status start_track(struct run *run, struct rb_error *err)\
{\
	struct rb_sink sink;\
	const enum rb_status status = rb_track_create(\&run->track, \&sink, run->options->track, err);\
\
	return status ? status : rb_pump_start(\&run->track_pump, run->ring, \&sink, \&run->outcome, err);\
}\
'
	place sink/track sink/module "a line of numbers for every frame"
}

try()
{
	cat >push.lua <<'END'
-- A pushed ball: its kinetic energy is 2 t^2.
world { duration = 1, frame_rate = 50, gravity_force = {2, 0, 0} }
sphere { radius = 0.1, mass = 1 }
END
	"$rbsim" push.lua -o push.h5 --track push.txt --quiet || fail "a run with the sample sink fails"
	awk '{ d = $2 - 2 * $1 * $1; if (d > 1e-12 || d < -1e-12 || $1 - n / 50 > 1e-12 || $1 - n / 50 < -1e-12) bad = 1; n++ }
		END { exit bad || n != 51 }' push.txt || fail "the sample sink did not get all frames"
	"$rbsim" push.lua --no-record --track alone.txt --quiet || fail "a run with nothing but the sample sink fails"
	cmp push.txt alone.txt || fail "the sample sink depends on the recorder"
	status=0
	"$rbsim" push.lua --no-record --track alone.txt --quiet 2>err || status=$?
	[ $status -eq 73 ] && grep -q "alone.txt" err || fail "a file that exists is not refused ($status)"
	echo 'world { duration = 1, gravity_force = {2, 0, 0} } on_step(function() error("stop") end) sphere { radius = 1 }' >stop.lua
	"$rbsim" stop.lua --no-record --track stop.txt --quiet 2>/dev/null && fail "the run did not fail"
	[ -z "$(ls stop.txt* 2>/dev/null)" ] || fail "a run that failed leaves a file"
}
