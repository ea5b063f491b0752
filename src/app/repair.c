/* SPDX-License-Identifier: MIT */
/*
 * A file whose writer was killed is opened as the recorder would resume it, after its last whole
 * frame, and closed as the run would have closed it: so there is one code that ends recordings. The
 * scene stored in it is loaded first, because the recorder needs the model, and because a file that
 * is not ours must not be written to.
 */
#include "app/repair.h"

#include <string.h>

#include "app/common.h"
#include "app/json.h"
#include "app/recorded.h"
#include "base/error.h"
#include "base/visible.h"
#include "sink/module.h"

/* What is to be known before the file is written to. */
struct patient {
	const char *path;
	const struct rb_hdf5_module *module;
	struct rb_loaded loaded;
	struct rb_run_info info;
	uint64_t row_count, frame; /* that are whole; of the last */
	struct rb_outcome outcome; /* what the file will say */
	char reason[RB_ERROR_TEXT_SIZE], status[32];
};

/*
 * What the file will say of the run's end: a run that was "running" was killed; anything else stays
 * as it is.
 */
static void judge(struct patient *patient, const struct rb_reading *reading)
{
	const bool running = strcmp(reading->status, "running") == 0;

	snprintf(patient->status, sizeof patient->status, "%s",
	         running ? "interrupted" : reading->status);
	snprintf(patient->reason, sizeof patient->reason, "%s",
	         running ? "the process was killed" : reading->reason);
	patient->outcome.reason = patient->reason;
	patient->outcome.status = strcmp(reading->status, "complete") == 0 ? RB_OK
	                          : strcmp(reading->status, "failed") == 0 ? RB_ERR_IO
	                                                                   : RB_ERR_TERMINATE;
}

/* Reads what is whole in the file, and loads its scene. */
static enum rb_status examine(struct patient *patient, const struct rb_options *options,
                              struct rb_error *err)
{
	struct rb_reader *reader;
	struct rb_frame frame;
	enum rb_status status = patient->module->reader_open(&reader, patient->path, err);

	if (status)
		return status;
	const struct rb_reading *const reading = patient->module->reader_reading(reader);
	patient->row_count = reading->frame_count;
	judge(patient, reading);
	if (patient->row_count == 0)
		status = RB_FAIL(err, RB_ERR_INPUT, "'%s' holds no frame", patient->path);
	else
		status = patient->module->reader_frame(reader, patient->row_count - 1, &frame, err);
	if (!status) {
		patient->frame = frame.index;
		status = rb_recorded_load(&patient->loaded, reading, patient->path, options->trust,
		                          err);
	}
	patient->module->reader_close(reader);
	return status;
}

/* Closes the file as the run itself would have. */
static enum rb_status close_again(struct patient *patient, struct rb_error *err)
{
	const struct rb_recorder_options options = {.path = patient->path,
	                                            .resume = true,
	                                            .repair = true,
	                                            .row_count = patient->row_count,
	                                            .frame = patient->frame};
	struct rb_recorder *recorder;
	struct rb_sink sink;

	RB_ASSERT(patient->row_count > 0);
	patient->info = (struct rb_run_info){.model = patient->loaded.model,
	                                     .scene = &patient->loaded.scene};
	enum rb_status status = patient->module->recorder_create(&recorder, &sink, &patient->info,
	                                                         &options, err);
	if (status)
		return status;
	status = sink.open(sink.self, err);
	if (!status)
		status = sink.close(sink.self, &patient->outcome, err);
	patient->module->recorder_destroy(recorder);
	return status;
}

/* Prints what was done. */
static void tell(const struct patient *patient, const struct rb_options *options)
{
	struct rb_json json = {.file = stdout};

	if (!options->json) {
		if (!options->quiet)
			rb_print(stdout, "'%s' is a plain file: %llu %s, %s%s%s\n", patient->path,
			         (unsigned long long)patient->row_count,
			         rb_text_plural(patient->row_count, "frame", "frames"),
			         patient->status, *patient->reason ? ": " : "", patient->reason);
		return;
	}
	rb_json_open(&json, NULL, '{');
	rb_json_text(&json, "file", patient->path);
	rb_json_text(&json, "status", patient->status);
	rb_json_text(&json, "reason", patient->reason);
	rb_json_count(&json, "frames", patient->row_count);
	rb_json_count(&json, "exit_status", 0);
	rb_json_close(&json, '}');
	putchar('\n');
}

int rb_repair_main(const struct rb_options *options)
{
	struct patient patient = {.path = options->operand[0]};
	struct rb_error err;
	enum rb_status status = rb_module_hdf5(&patient.module, &err);

	if (!status)
		status = examine(&patient, options, &err);
	if (!status)
		status = close_again(&patient, &err);
	rb_loaded_release(&patient.loaded);
	if (!status)
		tell(&patient, options);
	return rb_app_finish(options, status ? rb_app_refuse(options, &err) : 0);
}
