/* SPDX-License-Identifier: MIT */
/*
 * The rotation of a body since the first frame is told as a vector, its axis times the angle
 * (rx, ry, rz). As the logarithm of a rotation it is known but for whole turns about its axis; of
 * these it takes the one nearest to the frame before. So it grows on while a body spins about an
 * axis that keeps its direction, if it turns less than half a turn from frame to frame.
 *
 * Roll, pitch and yaw are those of z-y'-x'': the body is turned by yaw about z, then by pitch about
 * its new y, then by roll about its new x; at a pitch of a quarter turn only their sum is known.
 */
#include "app/quantity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/joint_type.h"
#include "script/nearest.h"

#define TURN 6.28318530717958647693

/* What is shown of the column. */
enum shown { AXIS, LENGTH, ROTATION, ANGLE, ROLL, PITCH, YAW };

/* What of a body can be told, behind its name and a point. */
#define COLUMN(member) offsetof(struct rb_frame, member)
#define VECTOR(x, y, z, length, column, units)                                    \
	{x, AXIS, 0, COLUMN(column), units}, {y, AXIS, 1, COLUMN(column), units}, \
		{z, AXIS, 2, COLUMN(column), units},                              \
	{                                                                         \
		length, LENGTH, 0, COLUMN(column), units                          \
	}
static const struct {
	const char *name;
	enum shown shown;
	int axis;
	size_t column; /* of struct rb_frame */
	const char *units;
} parts[] = {
	{"x", AXIS, 0, COLUMN(position), "m"},
	{"y", AXIS, 1, COLUMN(position), "m"},
	{"z", AXIS, 2, COLUMN(position), "m"},
	VECTOR("vx", "vy", "vz", "speed", velocity, "m/s"),
	VECTOR("wx", "wy", "wz", "spin", angular_velocity, "rad/s"),
	VECTOR("ax", "ay", "az", "acceleration", acceleration, "m/s^2"),
	VECTOR("fx", "fy", "fz", "force", force, "N"),
	VECTOR("tx", "ty", "tz", "torque", torque, "N m"),
	{"rx", ROTATION, 0, COLUMN(orientation), "rad"},
	{"ry", ROTATION, 1, COLUMN(orientation), "rad"},
	{"rz", ROTATION, 2, COLUMN(orientation), "rad"},
	{"angle", ANGLE, 0, COLUMN(orientation), "rad"},
	{"roll", ROLL, 0, COLUMN(orientation), "rad"},
	{"pitch", PITCH, 0, COLUMN(orientation), "rad"},
	{"yaw", YAW, 0, COLUMN(orientation), "rad"},
};
enum { PART_COUNT = sizeof parts / sizeof *parts };

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

	if (!dot)
		return false;
	for (int k = 0; k < PART_COUNT; k++)
		for (int i = 0; i < reading->body_count; i++) {
			char number[16];
			const char *const name = label_of(reading, reading->id[i], number);
			if (strcmp(dot + 1, parts[k].name) != 0 ||
			    strlen(name) != (size_t)(dot - text) ||
			    strncmp(name, text, (size_t)(dot - text)) != 0)
				continue;
			*body = i;
			*part = k;
			return true;
		}
	return false;
}

/* The rotation q as axis times angle, of all that differ by whole turns nearest to `before`. */
static rb_vec3 rotation_near(rb_quat q, rb_vec3 before)
{
	const rb_vec3 v = {q.x, q.y, q.z};
	const double sine = rb_vec3_length(v);

	if (!(sine > 0)) {
		/* whole turns about an axis that is not known but from before */
		const double length = rb_vec3_length(before);
		const double turns = round(length / TURN);

		return length > 0 ? rb_vec3_scale(turns * TURN / length, before) : before;
	}
	const rb_vec3 axis = rb_vec3_scale(1 / sine, v);
	const double angle = 2 * atan2(sine, q.w);
	const double along = rb_vec3_dot(before, axis);

	return rb_vec3_scale(angle + TURN * round((along - angle) / TURN), axis);
}

static double clamp_unit(double x)
{
	return fmax(-1, fmin(1, x));
}

/* What is shown of an orientation; `turn` goes on from frame to frame. */
static double of_orientation(const double *from, int part, rb_quat first, rb_vec3 *turn)
{
	const rb_quat q = rb_quat_from(from);
	const rb_quat back = {first.w, -first.x, -first.y, -first.z};

	switch (parts[part].shown) {
	case ROLL:
		return atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y));
	case PITCH:
		return asin(clamp_unit(2 * (q.w * q.y - q.z * q.x)));
	case YAW:
		return atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
	default:
		*turn = rotation_near(rb_quat_multiply(q, back), *turn);
		if (parts[part].shown == ANGLE)
			return rb_vec3_length(*turn);
		return parts[part].axis == 0 ? turn->x : parts[part].axis == 1 ? turn->y : turn->z;
	}
}

/* Reads a part of a body at all frames. */
static enum rb_status read_body(struct quantity *quantity, int body, int part, struct rb_error *err)
{
	rb_quat first = rb_quat_identity;
	rb_vec3 turn = {0};
	struct rb_frame frame;

	quantity->units = parts[part].units;
	for (uint64_t row = 0; row < quantity->reading->frame_count; row++) {
		const enum rb_status status = quantity->module->reader_frame(quantity->reader, row,
		                                                             &frame, err);
		if (status)
			return status;
		const double *from;
		memcpy(&from, (const char *)&frame + parts[part].column, sizeof from);
		if (!from)
			return RB_FAIL(err, RB_ERR_INPUT, "'%s' does not record what '%s' needs",
			               quantity->file, parts[part].name);
		if (parts[part].shown == AXIS) {
			quantity->values[row] = from[3 * body + parts[part].axis];
			continue;
		}
		if (parts[part].shown == LENGTH) {
			quantity->values[row] = rb_vec3_length(rb_vec3_from(from + 3 * body));
			continue;
		}
		if (row == 0)
			first = rb_quat_from(from + 4 * body);
		quantity->values[row] = of_orientation(from + 4 * body, part, first, &turn);
	}
	return RB_OK;
}

/* ---- joints ---- */

/* What is known of a joint, behind its name and a point. NULL units: of its angle or its way. */
#define JOINT_VECTOR(x, y, z, length, column, units)                        \
	{x, 3, 0, COLUMN(column), units}, {y, 3, 1, COLUMN(column), units}, \
		{z, 3, 2, COLUMN(column), units},                           \
	{                                                                   \
		length, 3, -1, COLUMN(column), units                        \
	}
static const struct {
	const char *name;
	int width, axis; /* axis -1: the length of a vector */
	size_t column;   /* of struct rb_frame */
	const char *units;
} joint_parts[] = {
	{"angle", 1, 0, COLUMN(joint_value), "rad"},
	{"way", 1, 0, COLUMN(joint_value), "m"},
	{"length", 1, 0, COLUMN(joint_value), "m"},
	{"speed", 1, 0, COLUMN(joint_speed), NULL},
	JOINT_VECTOR("fx", "fy", "fz", "force", joint_force, "N"),
	JOINT_VECTOR("tx", "ty", "tz", "torque", joint_torque, "N m"),
};
enum { JOINT_PART_COUNT = sizeof joint_parts / sizeof *joint_parts };

/*
 * Takes "NAME.angle" or "joint#K.angle" apart; false: it is not of that form, or there is no such
 * joint.
 */
static bool find_joint(const struct rb_reading *reading, const char *text, int *joint, int *part)
{
	const char *const dot = strrchr(text, '.');
	const size_t size = dot ? (size_t)(dot - text) : 0;

	for (int p = 0; dot && p < JOINT_PART_COUNT; p++)
		for (int k = 0; k < reading->joint_count; k++) {
			char number[24];
			const char *const name = reading->joint_names[k];

			snprintf(number, sizeof number, "joint#%d", k);
			if (strcmp(dot + 1, joint_parts[p].name) != 0 ||
			    !((strlen(name) == size && strncmp(name, text, size) == 0) ||
			      (strlen(number) == size && strncmp(number, text, size) == 0)))
				continue;
			*joint = k;
			*part = p;
			return true;
		}
	return false;
}

/* Reads a part of a joint at all frames. */
static enum rb_status read_joint(struct quantity *quantity, int joint, int part,
                                 struct rb_error *err)
{
	const struct rb_coordinate_words *words = rb_joint_words(
		quantity->reading->joint_kind[joint]);
	struct rb_frame frame;

	quantity->units = joint_parts[part].units;
	if (!quantity->units)
		quantity->units = words->name ? words->rate_unit : "m/s";
	for (uint64_t row = 0; row < quantity->reading->frame_count; row++) {
		const enum rb_status status = quantity->module->reader_frame(quantity->reader, row,
		                                                             &frame, err);
		const double *from;

		if (status)
			return status;
		memcpy(&from, (const char *)&frame + joint_parts[part].column, sizeof from);
		if (!from)
			return RB_FAIL(err, RB_ERR_INPUT,
			               "'%s' does not record joints (see 'fields' of record)",
			               quantity->file);
		from += (size_t)joint_parts[part].width * (size_t)joint;
		quantity->values[row] = joint_parts[part].axis < 0
		                                ? rb_vec3_length(rb_vec3_from(from))
		                                : from[joint_parts[part].axis];
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
