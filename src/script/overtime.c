/* SPDX-License-Identifier: MIT */
/*
 * What the handler may do, in order of rising force as the ticks go on: set Lua's hook (allowed in
 * a handler), which raises an error at the next instruction; jump out, if the interrupted code is
 * Lua's own library; end the process. The jump is allowed only there, since Lua is written to be
 * left by longjmp, but our own code and the allocator are not.
 *
 * Ticks count processor time of the thread, not wall time: a slow disk or a busy machine costs a
 * scene nothing.
 */
#include "script/overtime.h"

#include <errno.h>
#include <link.h>
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <ucontext.h>
#include <unistd.h>

#include "base/error.h"

/*
 * JUMP_TICKS: a sixth of the seconds after the hook was set, in which an error would have ended the
 * call. LAST_TICKS: after three times the seconds.
 */
enum { JUMP_TICKS = RB_OVERTIME_TICKS * 7 / 6, LAST_TICKS = 3 * RB_OVERTIME_TICKS };

/* s: far beyond what any scene of the distribution takes to load. */
static const double usual_seconds = 120;

/* Set once, before any handler runs. */
static pthread_once_t prepared_once = PTHREAD_ONCE_INIT;
static double seconds;
/*
 * The code of Lua's library; empty where it is linked into our own, where the two cannot be told
 * apart.
 */
static uintptr_t lua_from, lua_to; /* the code of Lua's library; empty where it is one with ours */
static char last_words[160];

static _Thread_local struct rb_overtime *volatile watched;
static _Thread_local bool ticking;
/* A handler is under way: setting the hook takes a time that grows with the depth of calls. */
static _Thread_local volatile sig_atomic_t handling;

double rb_overtime_seconds(void)
{
	const char *text = getenv("RBSIM_SCRIPT_SECONDS");
	const double value = text ? strtod(text, NULL) : 0;

	return value > 0 && value < 1e9 ? value : usual_seconds;
}

/*
 * Address at which the processor was when the signal came; 0: not known on this processor, so that
 * no jump is made.
 */
static uintptr_t interrupted_at(const ucontext_t *context)
{
#if defined(__x86_64__)
	return (uintptr_t)context->uc_mcontext.gregs[REG_RIP];
#elif defined(__aarch64__)
	return (uintptr_t)context->uc_mcontext.pc;
#else
	(void)context;
	return 0;
#endif
}

/* Handler of the timer: see the top of this file. */
static void tick(int number, siginfo_t *about, void *context)
{
	struct rb_overtime *const call = watched;

	(void)number;
	if (!call)
		return;
	call->ticks += 1 + about->si_overrun; /* the system's clock may be coarser */
	/* a tick within a handler is counted only: else handlers would pile up on the stack */
	if (!rb_overtime_is_up(call) || handling)
		return;
	handling = 1;
	lua_sethook(call->running, call->hook, LUA_MASKCOUNT, 1); /* Lua allows it in a handler */
	handling = 0;
	if (call->ticks < JUMP_TICKS)
		return;
	const uintptr_t at = interrupted_at(context);
	if (at >= lua_from && at < lua_to) {
		watched = NULL;
		siglongjmp(call->way_out, 1);
	}
	if (call->ticks >= LAST_TICKS) {
		const ssize_t told = write(STDERR_FILENO, last_words, strlen(last_words));
		(void)told; /* nobody else is left to tell */
		_exit(rb_status_exit_code(RB_ERR_SCENE));
	}
}

/*
 * For dl_iterate_phdr: finds the executable segment that Lua's functions are in. 1 ends the search.
 */
static int find_lua(struct dl_phdr_info *object, size_t size, void *user)
{
	(void)size;
	(void)user;
	for (int i = 0; i < object->dlpi_phnum; i++) {
		const ElfW(Phdr) *part = &object->dlpi_phdr[i];
		const uintptr_t from = (uintptr_t)(object->dlpi_addr + part->p_vaddr);
		const uintptr_t to = from + (uintptr_t)part->p_memsz;
		const uintptr_t lua = (uintptr_t)lua_newstate, ours = (uintptr_t)find_lua;
		if (part->p_type != PT_LOAD || !(part->p_flags & PF_X) || lua < from || lua >= to)
			continue;
		if (ours < from || ours >= to) {
			lua_from = from;
			lua_to = to;
		}
		return 1;
	}
	return 0;
}

/* In the child after fork: timers are not inherited. */
static void forget_timer(void)
{
	ticking = false;
}

/* What all threads share. */
static void prepare_once(void)
{
	seconds = rb_overtime_seconds();
	snprintf(last_words, sizeof last_words,
	         "rbsim: the script ran longer than %.9g seconds and can't be stopped "
	         "(--trust lifts this)\n",
	         seconds);
	(void)dl_iterate_phdr(find_lua, NULL);
	(void)pthread_atfork(NULL, NULL, forget_timer);
}

enum rb_status rb_overtime_prepare(struct rb_error *err)
{
	if (ticking)
		return RB_OK;
	(void)pthread_once(&prepared_once, prepare_once);

	/* not blocked within itself: the jump out of it leaves the mask as it was */
	struct sigaction action = {.sa_sigaction = tick};
	action.sa_flags = (int)(SA_SIGINFO | SA_RESTART | SA_NODEFER);
	struct sigevent event = {.sigev_notify = SIGEV_THREAD_ID, .sigev_signo = SIGVTALRM};
	event._sigev_un._tid = gettid();
	const double between = seconds / RB_OVERTIME_TICKS;
	struct itimerspec times = {0};
	times.it_interval.tv_sec = (time_t)between;
	times.it_interval.tv_nsec = (long)((between - floor(between)) * 1e9);
	/* a timer of zero would not run; tests ask for fractions of a second */
	if (times.it_interval.tv_sec == 0 && times.it_interval.tv_nsec < 1000000)
		times.it_interval.tv_nsec = 1000000;
	times.it_value = times.it_interval;
	sigset_t signals;
	timer_t timer;
	sigemptyset(&signals);
	sigaddset(&signals, SIGVTALRM);
	if (sigaction(SIGVTALRM, &action, NULL) != 0 ||
	    timer_create(CLOCK_THREAD_CPUTIME_ID, &event, &timer) != 0 ||
	    timer_settime(timer, 0, &times, NULL) != 0)
		return RB_FAIL(err, RB_ERR_IO, "cannot watch the time of a script: %s",
		               strerror(errno));
	pthread_sigmask(SIG_UNBLOCK, &signals, NULL);
	ticking = true; /* until the thread ends, and its timer with it */
	return RB_OK;
}

void rb_overtime_begin(struct rb_overtime *call)
{
	RB_ASSERT(watched == NULL && call->running && call->hook);
	call->ticks = 0;
	watched = call;
}

void rb_overtime_end(void)
{
	watched = NULL;
}
