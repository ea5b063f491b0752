/* SPDX-License-Identifier: MIT */
/*
 * The state of a point is never stored: it is derived, each time it is asked for, from the files
 * that its run has left. That way a killed sweep, two sweeps on one folder and a run repeated by
 * hand need no bookkeeping to be repaired. Order of the questions: no log: never begun; log locked:
 * running; result whole: done or failed, by the exit status in it; anything else: begun.
 *
 * The result file comes from our own program but may have been cut by a full disk or an editor, so
 * it is recognised as whole by its first and last bytes before anything is taken from it.
 */
#include "sweep/point.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "base/place.h"
#include "sweep/point_report.h"

/* 64 MiB: a result has a few hundred bytes for each expectation, so that more is not a result. */
static const size_t result_bytes_max = (size_t)64 << 20;

/* ---- what a run said at its end ---- */

/*
 * Number of places where `text` occurs; quotes inside JSON texts are escaped, so none is within
 * one.
 */
static int count_of(const char *json, const char *text)
{
	int count = 0;

	for (const char *at = strstr(json, text); at; at = strstr(at + 1, text))
		count++;
	return count;
}

/*
 * Fills point->reason: the error of the run, else why it stopped, else how many expectations
 * failed. Leaves it empty where the result has none of these.
 */
static void explain_failure(struct rb_point *point, const char *json)
{
	rb_point_report_text(json, "error", point->reason, sizeof point->reason);
	if (!*point->reason)
		rb_point_report_text(json, "reason", point->reason, sizeof point->reason);
	const int failed = count_of(json, "\"ok\":false");
	if (!*point->reason && failed > 0)
		snprintf(point->reason, sizeof point->reason, "%d of %d expectations failed",
		         failed, failed + count_of(json, "\"ok\":true"));
}

/*
 * Fills the point from the text of a result. False where the text is not whole; the point then
 * keeps its state. `*refused`: the scene expected to be refused and was, so there is no recording.
 */
static bool take_result(struct rb_point *point, const char *json, size_t size, bool *refused)
{
	char status[16];
	const char *const code = rb_point_report_value(json, "exit_status");

	RB_ASSERT(json[size] == '\0');
	if (size < 3 || *json != '{' || strcmp(json + size - 2, "}\n") != 0 || !code)
		return false;
	point->exit_code = atoi(code);
	rb_point_report_text(json, "status", status, sizeof status);
	rb_point_report_text(json, "state_hash", point->state_hash, sizeof point->state_hash);
	*refused = strcmp(status, "refused") == 0;
	switch (point->exit_code) {
	case 0:
		point->state = RB_POINT_DONE;
		break;
	case 75:  /* at a checkpoint */
	case 130: /* by a signal */
	case 143:
		point->state = RB_POINT_BEGUN;
		point->exit_code = 0;
		break;
	default:
		point->state = RB_POINT_FAILED;
		/*
		 * 1 expectations, 65 scene, 76 physics (RB_STATUS table in base/error.c):
		 * deterministic, so that another try would end the same way. All other failures may
		 * come from the machine.
		 */
		/* what expectations, scene and physics say, they would say again */
		point->may_mend = point->exit_code != 1 && point->exit_code != 65 &&
		                  point->exit_code != 76;
		explain_failure(point, json);
		break;
	}
	return true;
}

/* ---- its recording ---- */

/* Equal as texts, or as numbers: a recording stores "0.5" where the plan may say "5e-1". */
static bool same_value(const char *a, const char *b)
{
	char *end_a, *end_b;

	if (strcmp(a, b) == 0)
		return true;
	const double x = strtod(a, &end_a), y = strtod(b, &end_b);
	return end_a != a && end_b != b && *end_a == '\0' && *end_b == '\0' && x == y;
}

/*
 * Whether the recording was made with the values that the plan has for this point; further
 * parameters of the recording (defaults of the scene) do not count.
 */
static bool same_parameters(const struct rb_reading *reading, const struct rb_plan *plan,
                            uint64_t index)
{
	RB_ASSERT(index < plan->count);
	for (int i = 0; i < plan->axis_count; i++) {
		char number[RB_AXIS_NUMBER_SIZE];
		const char *const value = rb_plan_value(plan, index, i, number);
		bool same = false;
		for (int k = 0; k < reading->param_count && !same; k++)
			same = strcmp(reading->param_names[k], plan->axes[i].name) == 0 &&
			       same_value(reading->param_values[k], value);
		if (!same)
			return false;
	}
	return true;
}

/*
 * Whether the recording at `path` is the whole result of this point: complete, with the state hash
 * that the run reported, and of the same seed, parameters and scene text. A file that cannot be
 * read is not right. Guards against a recording that was replaced or restored from elsewhere.
 */
static bool recording_is_right(const struct rb_plan *plan, uint64_t index, const char *path,
                               const struct rb_hdf5_module *module, const char *hash)
{
	struct rb_reader *reader;
	char hex[65];

	RB_ASSERT(plan->file_count > 0);
	if (module->reader_open(&reader, path, NULL))
		return false;
	const struct rb_reading *const reading = module->reader_reading(reader);
	bool right = strcmp(reading->status, "complete") == 0 &&
	             strcmp(reading->state_hash, hash) == 0 &&
	             reading->seed == rb_plan_seed(plan, index) && reading->file_count > 0 &&
	             same_parameters(reading, plan, index);
	if (right) {
		rb_hash_sha256(reading->file_texts[0], reading->file_sizes[0], hex);
		right = strcmp(hex, plan->files[0].sha256) == 0;
	}
	module->reader_close(reader);
	return right;
}

/* ---- locks ---- */

/*
 * A lock of the open file, not of the process: children share it, and it goes with the last of
 * them.
 */
static struct flock whole_file(void)
{
	return (struct flock){.l_type = F_WRLCK, .l_whence = SEEK_SET};
}

/*
 * Whether some process holds the log. A log that cannot be opened counts as free: the attempt to
 * take it later tells why.
 */
static bool is_locked(const char *log)
{
	struct flock lock = whole_file();
	const int descriptor = open(log, O_RDONLY | O_CLOEXEC);
	bool locked = false;

	if (descriptor < 0)
		return false;
	if (fcntl(descriptor, F_OFD_GETLK, &lock) == 0)
		locked = lock.l_type != F_UNLCK;
	close(descriptor);
	return locked;
}

enum rb_status rb_point_lock(const char *folder, const struct rb_plan *plan, uint64_t index,
                             int *descriptor, struct rb_error *err)
{
	struct flock lock = whole_file();
	char path[RB_FOLDER_PATH_SIZE];
	struct rb_place place;

	RB_ASSERT(index < plan->count);
	*descriptor = -1;
	const enum rb_status status = rb_place_open(
		&place, rb_folder_path(plan, folder, index, ".log", path), 0, err);
	if (status)
		return status;
	*descriptor = rb_place_reach(&place, place.name, O_RDWR | O_CREAT | O_APPEND);
	const int number = errno;
	rb_place_release(&place);
	if (*descriptor < 0)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", path,
		               strerror(number));
	/* a file system without locks is taken as it is */
	if (fcntl(*descriptor, F_OFD_SETLK, &lock) != 0 && (errno == EAGAIN || errno == EACCES)) {
		close(*descriptor);
		*descriptor = -1;
	}
	return RB_OK;
}

void rb_point_unlock(int descriptor)
{
	struct flock lock = whole_file();

	RB_ASSERT(descriptor >= 0);
	lock.l_type = F_UNLCK;
	(void)fcntl(descriptor, F_OFD_SETLK, &lock);
	close(descriptor);
}

/* ---- the point ---- */

enum rb_status rb_point_look(const char *folder, const struct rb_plan *plan, uint64_t index,
                             const struct rb_hdf5_module *module, struct rb_point *point,
                             struct rb_error *err)
{
	char path[RB_FOLDER_PATH_SIZE];
	bool refused = false;

	RB_ASSERT(index < plan->count);
	*point = (struct rb_point){.state = RB_POINT_MISSING};
	rb_folder_path(plan, folder, index, ".log", path);
	if (access(path, F_OK) != 0)
		return RB_OK;
	point->state = RB_POINT_BEGUN;
	if (is_locked(path)) {
		point->state = RB_POINT_RUNNING;
		return RB_OK;
	}
	rb_folder_path(plan, folder, index, ".json", path);
	if (access(path, F_OK) == 0) {
		char *json;
		size_t size;
		const enum rb_status status = rb_folder_read(path, result_bytes_max, &json, &size,
		                                             err);
		if (status)
			return status;
		if (!take_result(point, json, size, &refused))
			point->state = RB_POINT_BEGUN;
		rb_memory_free(json);
	}
	rb_folder_path(plan, folder, index, ".h5.checkpoint", path);
	point->has_checkpoint = plan->records && access(path, F_OK) == 0;
	rb_folder_path(plan, folder, index, ".h5", path);
	if (point->state == RB_POINT_DONE && plan->records && !refused &&
	    (access(path, F_OK) != 0 ||
	     (module && !recording_is_right(plan, index, path, module, point->state_hash))))
		point->state = RB_POINT_BEGUN;
	return RB_OK;
}

bool rb_point_is_due(const struct rb_point *point, bool retry)
{
	RB_ASSERT(point->state < RB_POINT_STATE_COUNT);
	return point->state == RB_POINT_MISSING || point->state == RB_POINT_BEGUN ||
	       (point->state == RB_POINT_FAILED && (retry || point->may_mend));
}

enum rb_status rb_point_tell(const char *folder, const struct rb_plan *plan, uint64_t index,
                             const char *reason, int exit_code, struct rb_error *err)
{
	char path[RB_FOLDER_PATH_SIZE];
	struct rb_outfile out;
	const enum rb_status status = rb_outfile_open(
		&out, rb_folder_path(plan, folder, index, ".json", path), true, err);

	if (status)
		return status;
	fprintf(out.file,
	        "{\"status\":\"crashed\",\"reason\":\"%s\",\"exit_status\":%d,\"error\":\"%s\"}\n",
	        reason, exit_code, reason);
	return rb_outfile_publish(&out, err);
}
