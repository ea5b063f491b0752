/* SPDX-License-Identifier: MIT */
#include "flow/schedule.h"

#include <float.h>
#include <math.h>

/* Beyond that, numbers of pictures are no longer told apart. */
static const double count_max = 9007199254740992.0;

struct rb_schedule rb_schedule_of(const struct rb_camera_def *camera, double frame_rate,
                                  double end_s)
{
	return (struct rb_schedule){.from_s = camera->from_s,
	                            .to_s = fmin(camera->to_s, end_s),
	                            .fps = isnan(camera->fps) ? frame_rate : camera->fps,
	                            .speed = camera->speed};
}

uint64_t rb_schedule_count(const struct rb_schedule *schedule)
{
	const double from = schedule->from_s, to = schedule->to_s;
	const double per_second = schedule->fps / schedule->speed; /* pictures, of simulated time */

	if (!(from <= to))
		return 0;
	const double steps = (to - from) * per_second;
	if (!(steps < count_max))
		return (uint64_t)count_max;
	/* what rounding of both times, of their difference and of the quotient can make of a whole number */
	const double noise = 8 * DBL_EPSILON * (fmax(fabs(from), fabs(to)) * per_second + steps);
	const double nearest = nearbyint(steps);
	const double whole = fabs(steps - nearest) <= noise ? nearest : floor(steps);
	return (uint64_t)whole + 1;
}

double rb_schedule_time(const struct rb_schedule *schedule, uint64_t picture)
{
	const double since = (double)picture * schedule->speed / schedule->fps;

	return fmin(schedule->from_s + since, schedule->to_s);
}
