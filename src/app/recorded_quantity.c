/* SPDX-License-Identifier: MIT */
#include "app/recorded_quantity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/quantity.h"
#include "math/vec3.h"
#include "script/nearest.h"

/* One quantity that is read. */
struct quantity {
	const struct rb_hdf5_module *module;
	struct rb_reader *reader;
	const struct rb_reading *reading;
	const char *file, *name;
	double *values;
	const char *units;
};

/* What messages call a body: its name, or "#ID". */
static const char *label_of(const struct rb_reading *reading, int id, char out[16])
{
	if (*reading->names[id])
		return reading->names[id];
	snprintf(out, 16, "#%d", id);
	return out;
}

/*
 * Takes "NAME.z" or "#ID.z" apart; false: it is not of that form, or there is no such body that
 * moves.
 */
static bool find_body(const struct rb_reading *reading, const char *text, int *body, int *part)
{
	const char *const dot = strrchr(text, '.');

	*part = dot ? rb_body_part_named(dot + 1) : -1;
	for (int i = 0; *part >= 0 && i < reading->body_count; i++) {
		char number[16];
		const char *const name = label_of(reading, reading->id[i], number);
		if (strlen(name) != (size_t)(dot - text) ||
		    strncmp(name, text, (size_t)(dot - text)) != 0)
			continue;
		*body = i;
		return true;
	}
	return false;
}

/* Reads a part of a body at all frames. */
static enum rb_status read_body(struct quantity *quantity, int body, int part, struct rb_error *err)
{
	struct rb_quantity_turn turn = {0};
	struct rb_frame frame;

	quantity->units = rb_body_part_units(part);
	for (uint64_t row = 0; row < quantity->reading->frame_count; row++) {
		const enum rb_status status = quantity->module->reader_frame(quantity->reader, row,
		                                                             &frame, err);
		if (status)
			return status;
		if (!rb_body_part_value(part, &frame, body, &turn, &quantity->values[row]))
			return RB_FAIL(err, RB_ERR_INPUT, "'%s' does not record what '%s' needs",
			               quantity->file, quantity->name);
	}
	return RB_OK;
}

/* ---- joints ---- */

/*
 * Takes "NAME.angle" or "joint#K.angle" apart; false: it is not of that form, or there is no such
 * joint.
 */
static bool find_joint(const struct rb_reading *reading, const char *text, int *joint, int *part)
{
	const char *const dot = strrchr(text, '.');
	const size_t size = dot ? (size_t)(dot - text) : 0;

	*part = dot ? rb_joint_part_named(dot + 1) : -1;
	for (int k = 0; *part >= 0 && k < reading->joint_count; k++) {
		char number[24];
		const char *const name = reading->joint_names[k];

		snprintf(number, sizeof number, "joint#%d", k);
		if (!((strlen(name) == size && strncmp(name, text, size) == 0) ||
		      (strlen(number) == size && strncmp(number, text, size) == 0)))
			continue;
		*joint = k;
		return true;
	}
	return false;
}

/* Reads a part of a joint at all frames. */
static enum rb_status read_joint(struct quantity *quantity, int joint, int part,
                                 struct rb_error *err)
{
	struct rb_frame frame;

	quantity->units = rb_joint_part_units(part, quantity->reading->joint_kind[joint]);
	for (uint64_t row = 0; row < quantity->reading->frame_count; row++) {
		const enum rb_status status = quantity->module->reader_frame(quantity->reader, row,
		                                                             &frame, err);
		if (status)
			return status;
		if (!rb_joint_part_value(part, &frame, joint, &quantity->values[row]))
			return RB_FAIL(err, RB_ERR_INPUT,
			               "'%s' does not record joints (see 'fields' of record)",
			               quantity->file);
	}
	return RB_OK;
}

/* ---- all of a frame ---- */

/* The energy, the sum of both. */
static enum rb_status read_energy(struct quantity *quantity, double *more, struct rb_error *err)
{
	const struct rb_hdf5_module *const module = quantity->module;
	enum rb_status status = module->reader_observable(quantity->reader, "kinetic_energy", 1,
	                                                  quantity->values, err);

	if (!status)
		status = module->reader_observable(quantity->reader, "potential_energy", 1, more,
		                                   err);
	for (uint64_t i = 0; i < quantity->reading->frame_count && !status; i++)
		quantity->values[i] += more[i];
	quantity->units = "J";
	return status;
}

/* What may have been meant: a probe, a sum over all bodies, or a body with what is asked of it. */
static const char *hint_of(const struct quantity *quantity, char out[96])
{
	static const char *const sums[] = {"energy",      "kinetic_energy", "potential_energy",
	                                   "momentum",    "time",           "angular_momentum",
	                                   "penetration", "max_penetration"};
	const struct rb_reading *const reading = quantity->reading;
	const char *const dot = strrchr(quantity->name, '.');
	struct rb_nearest nearest = rb_nearest_to(quantity->name);

	for (size_t k = 0; k < sizeof sums / sizeof *sums; k++)
		rb_nearest_offer(&nearest, sums[k], strlen(sums[k]));
	for (int k = 0; k < reading->probe_count; k++)
		rb_nearest_offer(&nearest, reading->probe_names[k],
		                 strlen(reading->probe_names[k]));
	for (int i = 0; i < reading->body_count && dot; i++) {
		const char *const body_name = reading->names[reading->id[i]];
		char meant[64];
		const int size = snprintf(meant, sizeof meant, "%s%s", body_name, dot);
		int body, part;

		if (*body_name && size < (int)sizeof meant &&
		    find_body(reading, meant, &body, &part))
			rb_nearest_offer(&nearest, meant, (size_t)size);
	}
	return rb_nearest_hint(&nearest, out);
}

/* Reads a number for each frame; of vectors their length. */
static enum rb_status read_observable(struct quantity *quantity, double *more, struct rb_error *err)
{
	const struct rb_hdf5_module *const module = quantity->module;
	const uint64_t count = quantity->reading->frame_count;
	const char *const name = strcmp(quantity->name, "penetration") == 0 ? "max_penetration"
	                                                                    : quantity->name;
	char hint[96];

	if (strcmp(name, "energy") == 0)
		return read_energy(quantity, more, err);
	quantity->units = module->reader_units(quantity->reader, name);
	if (module->reader_observable(quantity->reader, name, 1, quantity->values, NULL) == RB_OK)
		return RB_OK;
	if (module->reader_observable(quantity->reader, name, 3, more, NULL) == RB_OK) {
		for (uint64_t i = 0; i < count; i++)
			quantity->values[i] = rb_vec3_length(rb_vec3_from(more + 3 * i));
		return RB_OK;
	}
	return RB_FAIL(err, RB_ERR_USAGE,
	               "'%s' has no quantity '%.60s'%s (wanted: energy, momentum, "
	               "penetration, a probe, BODY.z, .vz, .speed, or JOINT.angle, .force, and "
	               "more: rbsim(1), plot)",
	               quantity->file, name, hint_of(quantity, hint));
}

enum rb_status rb_quantity_read(const struct rb_quantity_source *source, const char *name,
                                double *values, const char **units, struct rb_error *err)
{
	const struct rb_hdf5_module *const module = source->module;
	struct rb_reader *const reader = source->reader;
	struct quantity quantity = {.module = module,
	                            .reader = reader,
	                            .reading = module->reader_reading(reader),
	                            .file = source->file,
	                            .name = name,
	                            .values = values,
	                            .units = ""};
	const struct rb_reading *const reading = quantity.reading;
	char probe[RB_MEASURE_NAME_MAX * 4];
	enum rb_status status;
	int body, joint, part;

	/* the scene's own names go first */
	for (int i = 0; i < reading->probe_count; i++) {
		if (strcmp(reading->probe_names[i], name) != 0)
			continue;
		*units = reading->probe_units[i];
		snprintf(probe, sizeof probe, "probes/%s", name);
		return module->reader_observable(reader, probe, 1, values, err);
	}
	if (find_body(reading, name, &body, &part)) {
		status = read_body(&quantity, body, part, err);
	} else if (find_joint(reading, name, &joint, &part)) {
		status = read_joint(&quantity, joint, part, err);
	} else {
		double *const more = rb_memory_take((size_t)reading->frame_count + 1,
		                                    3 * sizeof *more);
		if (!more)
			return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory",
			               source->file);
		status = read_observable(&quantity, more, err);
		rb_memory_free(more);
	}
	*units = quantity.units;
	return status;
}
