/* SPDX-License-Identifier: MIT */
/*
 * What several verbs share: loading a scene, telling errors, ending output, how numbers look. Main
 * thread.
 */
#ifndef RB_APP_COMMON_H
#define RB_APP_COMMON_H

#include <stdint.h>
#include <stdio.h>

#include <rbsim.h>
#include <rbsim/error.h>
#include <rbsim/math.h>
#include <rbsim/model.h>

#include "app/options.h"
#include "base/visible.h"
#include "script/load.h"

#define RB_VERSION RBSIM_VERSION

/* A scene as this command line wants it. The owner releases it, after the world made from it. */
struct rb_loaded {
	struct rb_script *script;
	struct rb_scene scene;
	struct rb_model *model;
	struct rb_mistakes mistakes;
	char *output; /* the recording's name; NULL: none is wanted */
	unsigned how; /* it may be made: of base/place */
};

/*
 * Loads the scene of the first operand, puts the options in place of what it says, and seals the
 * model.
 */
RB_CHECKED enum rb_status rb_loaded_init(struct rb_loaded *loaded, const struct rb_options *options,
                                         struct rb_error *err);
/*
 * The same scene once more, from the files as they were read then, with the parameters of these
 * options. `stop` says whether to give it up: RB_ERR_SCENE.
 */
RB_CHECKED enum rb_status rb_loaded_again(struct rb_loaded *loaded, const struct rb_loaded *from,
                                          const struct rb_options *options,
                                          bool (*stop)(void *user), void *user,
                                          struct rb_error *err);
void rb_loaded_release(struct rb_loaded *loaded); /* safe on a zeroed one */

/* Tells an error on standard error and gives its exit status; with --debug also where it arose. */
int rb_app_fail(const struct rb_options *options, const struct rb_error *err);

/* Whether a scene expects to be refused this way (expect_refused). */
bool rb_app_refused_as_expected(const struct rb_loaded *loaded, const struct rb_error *err);

/*
 * As rb_app_fail, with every mistake of the scene on a line of its own, or the traceback of a
 * callback that has failed. A scene that expects to be
 * refused this way (expect_refused) is told so and gives 0.
 */
int rb_app_fail_scene(const struct rb_options *options, const struct rb_loaded *loaded,
                      const struct rb_error *err);
/*
 * With --json: the one object of a run that was not started, or of a check or another verb that
 * failed, on standard output. `loaded` may be NULL.
 */
void rb_app_json_refusal(const struct rb_options *options, const struct rb_loaded *loaded,
                         const struct rb_error *err, int exit_code);
/* rb_app_fail with rb_app_json_refusal. */
int rb_app_refuse(const struct rb_options *options, const struct rb_error *err);
/* rb_app_fail_scene with rb_app_json_refusal. */
int rb_app_refuse_scene(const struct rb_options *options, const struct rb_loaded *loaded,
                        const struct rb_error *err);
/* A scene that expects to be refused and was not: tells it and gives the exit status. */
int rb_app_not_refused(const struct rb_loaded *loaded);

/*
 * The end of a verb: standard output is flushed; `exit_code` if all of it was written or there is
 * a failure to tell already, that of RB_ERR_IO otherwise (a closed pipe, a full disk). A verdict
 * (1) that could not be written is no failure to tell.
 */
int rb_app_finish(const struct rb_options *options, int exit_code);

/*
 * Memory of this process in bytes, "VmHWM" (largest resident set) or "VmRSS" (resident now); what
 * base/memory knows where the system does not tell.
 */
uint64_t rb_process_bytes(const char *key);

/* The larger one, NAN if one of them is (fmax would pass over it). */
double rb_larger(double a, double b);

/* |now - then|, NAN if a component is not finite (a length may pass over it). */
double rb_change_of(rb_vec3 now, rb_vec3 then);

/* A measured value for people, `before` in front of it: by up to 12.5 J, or "not finite" alone. */
const char *rb_text_measure(const char *before, double value, int digits, const char *unit,
                            char out[64]);

/* A size for people: 512 bytes, 1.2 kB, 34 MB. */
const char *rb_text_bytes(uint64_t bytes, char out[32]);

/*
 * Overlaps that frames may show: 1e-06 m, or 1e-06 m until the first step, then 0.0001 m. `digits`
 * is of each number.
 */
const char *rb_text_tolerance(double located_m, double stepped_m, int digits, char out[96]);

/*
 * Forces of a scene that are neither gravity nor a body's own: "2 springs, 1 field", "" without
 * any.
 */
enum { RB_FORCES_TEXT_SIZE = 512 };
const char *rb_text_forces(const int element_counts[RB_ELEMENT_KINDS_MAX], int fields,
                           char out[RB_FORCES_TEXT_SIZE]);
struct rb_json;
/*
 * "2 hinges, 1 rope", "" without any, from the number of joints of each kind.
 */
enum { RB_JOINTS_TEXT_SIZE = 32 * RB_JOINT_KIND_COUNT };
const char *rb_text_joints(const int counts[RB_JOINT_KIND_COUNT], char out[RB_JOINTS_TEXT_SIZE]);

/* The same: "spring_count", ..., "field_count". */
void rb_json_forces(struct rb_json *json, const int element_counts[RB_ELEMENT_KINDS_MAX],
                    int fields);
/* "2 spheres, 1 box"; "" where there are only spheres and planes, which needs no words. */
const char *rb_text_shapes(const int counts[RB_SHAPE_KIND_COUNT], char out[160]);

#endif
