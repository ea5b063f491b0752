/* SPDX-License-Identifier: MIT */
/*
 * The processor time of calls into Lua, and the way out of one that nothing else ends.
 *
 * Lua's count hook sees no time that Lua spends in its own C code, and a line of a script can keep
 * that busy for hours: a table that is its own __call, compared with by table.sort. So a timer of
 * the thread's own processor time ticks, seldom enough that an ordinary run meets none or a few.
 * When a call has had its seconds, each further instruction of the script asks the hook, and
 * functions of ours that take long ask for themselves; a call that neither ends is left by a jump
 * to `way_out`, but only while the processor is in Lua's library itself: neither the allocator nor
 * code of ours is cut in two. The state of Lua is then lost: it must not be touched any more, not
 * even to close it. Where that does not come about either, the process ends with status 65, and
 * what a recording holds by then is there for `rbsim repair`.
 *
 * Time only ends calls: nothing that a script could see depends on it.
 */
#ifndef RB_SCRIPT_OVERTIME_H
#define RB_SCRIPT_OVERTIME_H

#include <setjmp.h>
#include <signal.h>
#include <stdbool.h>

#include <lua.h>

#include <rbsim/error.h>

/*
 * In the seconds of a call. Many: a call that spends nine tenths of its time in the C library,
 * where none can be ended, is met outside it all the same.
 */
enum { RB_OVERTIME_TICKS = 96 };

/* One call. Belongs to the thread that makes it and to the signal's handler on this thread. */
struct rb_overtime {
	volatile sig_atomic_t ticks;
	lua_State *volatile running; /* which coroutine is being run; set by whoever resumes one */
	lua_Hook hook;               /* what raises the error */
	sigjmp_buf way_out; /* set by the caller, in a frame that is there until rb_overtime_end */
};

/* Of processor time that a call may take: 120, or what RBSIM_SCRIPT_SECONDS says. */
double rb_overtime_seconds(void);

/* From here on calls of this thread can be watched; again costs nothing. RB_ERR_IO: no timer. */
RB_CHECKED enum rb_status rb_overtime_prepare(struct rb_error *err);

/* The calling thread's call begins, `way_out` having been set; and is over, also by the jump. */
void rb_overtime_begin(struct rb_overtime *call);
void rb_overtime_end(void);

/*
 * The call has had its seconds: the first tick can come at any time, so that one more is waited
 * for.
 */
static inline bool rb_overtime_is_up(const struct rb_overtime *call)
{
	return call->ticks > RB_OVERTIME_TICKS;
}

#endif
