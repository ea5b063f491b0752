/* SPDX-License-Identifier: MIT */
#include "flow/quantity.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/error.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "model/joint_type.h"

#define TURN 6.28318530717958647693

/* What is shown of the column. */
enum shown { AXIS, LENGTH, ROTATION, ANGLE, ROLL, PITCH, YAW };

/* What of a body can be told, behind its name and a point. */
#define COLUMN(member) offsetof(struct rb_frame, member)
#define VECTOR(x, y, z, length, column, units, field)                                           \
	{x, AXIS, 0, COLUMN(column), units, field}, {y, AXIS, 1, COLUMN(column), units, field}, \
		{z, AXIS, 2, COLUMN(column), units, field},                                     \
	{                                                                                       \
		length, LENGTH, 0, COLUMN(column), units, field                                 \
	}
static const struct {
	const char *name;
	enum shown shown;
	int axis;
	size_t column; /* of struct rb_frame */
	const char *units;
	unsigned field;
} parts[] = {
	{"x", AXIS, 0, COLUMN(position), "m", RB_FIELD_POSITION},
	{"y", AXIS, 1, COLUMN(position), "m", RB_FIELD_POSITION},
	{"z", AXIS, 2, COLUMN(position), "m", RB_FIELD_POSITION},
	VECTOR("vx", "vy", "vz", "speed", velocity, "m/s", RB_FIELD_VELOCITY),
	VECTOR("wx", "wy", "wz", "spin", angular_velocity, "rad/s", RB_FIELD_ANGULAR_VELOCITY),
	VECTOR("ax", "ay", "az", "acceleration", acceleration, "m/s^2", RB_FIELD_ACCELERATION),
	VECTOR("fx", "fy", "fz", "force", force, "N", RB_FIELD_FORCE),
	VECTOR("tx", "ty", "tz", "torque", torque, "N m", RB_FIELD_TORQUE),
	{"rx", ROTATION, 0, COLUMN(orientation), "rad", RB_FIELD_ORIENTATION},
	{"ry", ROTATION, 1, COLUMN(orientation), "rad", RB_FIELD_ORIENTATION},
	{"rz", ROTATION, 2, COLUMN(orientation), "rad", RB_FIELD_ORIENTATION},
	{"angle", ANGLE, 0, COLUMN(orientation), "rad", RB_FIELD_ORIENTATION},
	{"roll", ROLL, 0, COLUMN(orientation), "rad", RB_FIELD_ORIENTATION},
	{"pitch", PITCH, 0, COLUMN(orientation), "rad", RB_FIELD_ORIENTATION},
	{"yaw", YAW, 0, COLUMN(orientation), "rad", RB_FIELD_ORIENTATION},
};
enum { PART_COUNT = sizeof parts / sizeof *parts };

int rb_body_part_named(const char *name)
{
	for (int k = 0; k < PART_COUNT; k++)
		if (strcmp(parts[k].name, name) == 0)
			return k;
	return -1;
}

unsigned rb_body_part_field(int part)
{
	RB_ASSERT(part >= 0 && part < PART_COUNT);
	return parts[part].field;
}

const char *rb_body_part_units(int part)
{
	RB_ASSERT(part >= 0 && part < PART_COUNT);
	return parts[part].units;
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

bool rb_body_part_value(int part, const struct rb_frame *frame, int body,
                        struct rb_quantity_turn *turn, double *value)
{
	const double *from;

	RB_ASSERT(part >= 0 && part < PART_COUNT && body >= 0 && body < frame->body_count);
	memcpy(&from, (const char *)frame + parts[part].column, sizeof from);
	if (!from)
		return false;
	if (parts[part].shown == AXIS) {
		*value = from[3 * body + parts[part].axis];
		return true;
	}
	if (parts[part].shown == LENGTH) {
		*value = rb_vec3_length(rb_vec3_from(from + 3 * body));
		return true;
	}
	if (!turn->begun) {
		turn->begun = true;
		turn->first = rb_quat_from(from + 4 * body);
	}
	*value = of_orientation(from + 4 * body, part, turn->first, &turn->turn);
	return true;
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

int rb_joint_part_named(const char *name)
{
	for (int k = 0; k < JOINT_PART_COUNT; k++)
		if (strcmp(joint_parts[k].name, name) == 0)
			return k;
	return -1;
}

bool rb_joint_part_is_of(int part, int kind)
{
	const char *const coordinate = rb_joint_words(kind)->name;

	RB_ASSERT(part >= 0 && part < JOINT_PART_COUNT);
	if (joint_parts[part].width == 3)
		return true;
	return coordinate &&
	       (!joint_parts[part].units || strcmp(joint_parts[part].name, coordinate) == 0);
}

const char *rb_joint_part_units(int part, int kind)
{
	const struct rb_coordinate_words *const words = rb_joint_words(kind);

	RB_ASSERT(part >= 0 && part < JOINT_PART_COUNT);
	if (joint_parts[part].units)
		return joint_parts[part].units;
	return words->name ? words->rate_unit : "m/s";
}

bool rb_joint_part_value(int part, const struct rb_frame *frame, int joint, double *value)
{
	const double *from;

	RB_ASSERT(part >= 0 && part < JOINT_PART_COUNT);
	memcpy(&from, (const char *)frame + joint_parts[part].column, sizeof from);
	if (!from)
		return false;
	from += (size_t)joint_parts[part].width * (size_t)joint;
	*value = joint_parts[part].axis < 0 ? rb_vec3_length(rb_vec3_from(from))
	                                    : from[joint_parts[part].axis];
	return true;
}

/* ---- all of a frame ---- */

/* As the recording calls them; of vectors the length. */
enum world_part { ENERGY, KINETIC, POTENTIAL, MOMENTUM, ANGULAR, COLLISIONS, CONTACTS, OVERLAP };
static const struct {
	const char *name, *units;
} world_parts[] = {
	[ENERGY] = {"energy", "J"},
	[KINETIC] = {"kinetic_energy", "J"},
	[POTENTIAL] = {"potential_energy", "J"},
	[MOMENTUM] = {"momentum", "kg m/s"},
	[ANGULAR] = {"angular_momentum", "kg m^2/s"},
	[COLLISIONS] = {"collisions", ""},
	[CONTACTS] = {"contacts", ""},
	[OVERLAP] = {"max_penetration", "m"},
};
enum { WORLD_PART_COUNT = sizeof world_parts / sizeof *world_parts };

int rb_world_part_named(const char *name)
{
	for (int k = 0; k < WORLD_PART_COUNT; k++)
		if (strcmp(world_parts[k].name, name) == 0)
			return k;
	return -1;
}

const char *rb_world_part_name(int part)
{
	RB_ASSERT(part >= 0);
	return part < WORLD_PART_COUNT ? world_parts[part].name : NULL;
}

const char *rb_world_part_units(int part)
{
	RB_ASSERT(part >= 0 && part < WORLD_PART_COUNT);
	return world_parts[part].units;
}

double rb_world_part_value(int part, const struct rb_frame *frame)
{
	const struct rb_frame_numbers *const numbers = &frame->numbers;

	switch ((enum world_part)part) {
	case ENERGY:
		return numbers->kinetic_energy + numbers->potential_energy;
	case KINETIC:
		return numbers->kinetic_energy;
	case POTENTIAL:
		return numbers->potential_energy;
	case MOMENTUM:
		return rb_vec3_length(numbers->momentum);
	case ANGULAR:
		return rb_vec3_length(numbers->angular_momentum);
	case COLLISIONS:
		return (double)numbers->collisions;
	case CONTACTS:
		return (double)numbers->contacts;
	case OVERLAP:
		return numbers->max_penetration;
	}
	return (double)NAN;
}

/* ---- rounding ---- */

/* Units that gravity and a size of the bodies give: m, m/s, rad/s, m/s^2, N and N m. */
struct natural {
	double length, speed, spin, acceleration, force, torque;
};

/* Of a body by its index; of what has no mass only those without it. */
static struct natural natural_of(const struct rb_model *model, int body)
{
	const double size = rb_model_reach(model, body);
	const double length = isfinite(size) ? size : model->size_mean_m;
	const double mass = body < model->body_count && isfinite(model->mass[body])
	                            ? model->mass[body]
	                            : 0;
	const double gravity = rb_vec3_length(model->scene->world.gravity);

	return (struct natural){.length = length,
	                        .speed = sqrt(gravity * length),
	                        .spin = length > 0 ? sqrt(gravity / length) : 0,
	                        .acceleration = gravity,
	                        .force = mass * gravity,
	                        .torque = mass * gravity * length};
}

double rb_body_part_magnitude(int part, const struct rb_model *model, const struct rb_frame *frame,
                              int body)
{
	const struct natural natural = natural_of(model, body);
	double least = 1; /* of angles, rad */
	const double *from;

	RB_ASSERT(part >= 0 && part < PART_COUNT && body >= 0 && body < frame->body_count);
	if (parts[part].shown != AXIS && parts[part].shown != LENGTH)
		return least;
	switch (parts[part].field) {
	case RB_FIELD_POSITION:
		least = natural.length;
		break;
	case RB_FIELD_VELOCITY:
		least = natural.speed;
		break;
	case RB_FIELD_ANGULAR_VELOCITY:
		least = natural.spin;
		break;
	case RB_FIELD_ACCELERATION:
		least = natural.acceleration;
		break;
	case RB_FIELD_FORCE:
		least = natural.force;
		break;
	default:
		least = natural.torque;
		break;
	}
	memcpy(&from, (const char *)frame + parts[part].column, sizeof from);
	return from ? fmax(least, rb_vec3_length(rb_vec3_from(from + 3 * body))) : least;
}

double rb_joint_part_magnitude(int part, const struct rb_model *model, const struct rb_frame *frame,
                               int joint)
{
	const struct rb_joint_def *const def = &model->scene->joints[joint];
	const int a = model->index_of[def->a], b = def->b >= 0 ? model->index_of[def->b] : a;
	const struct natural natural = natural_of(model, a < model->body_count ? a : b);
	const char *const units = rb_joint_part_units(part, def->kind);
	const bool turns = strncmp(units, "rad", 3) == 0;
	const double *from;

	RB_ASSERT(part >= 0 && part < JOINT_PART_COUNT);
	memcpy(&from, (const char *)frame + joint_parts[part].column, sizeof from);
	if (joint_parts[part].width == 3) {
		const double least = strcmp(units, "N") == 0 ? natural.force : natural.torque;

		return from ? fmax(least, rb_vec3_length(rb_vec3_from(from + 3 * (size_t)joint)))
		            : least;
	}
	if (!joint_parts[part].units)
		return turns ? natural.spin : natural.speed;
	return turns ? 1 : natural.length;
}

/* m, how far bodies are from the origin, or as large as they are. */
static double reach_of(const struct rb_model *model, const struct rb_frame *frame)
{
	double far = model->size_mean_m;

	for (int i = 0; frame->position && i < frame->body_count; i++)
		far = fmax(far, rb_vec3_length(rb_vec3_from(frame->position + 3 * i)));
	return far;
}

/* kg m/s, the largest momentum that bodies with this kinetic energy may have together. */
static double momentum_bound(const struct rb_model *model, const struct rb_frame *frame)
{
	double mass = 0;

	for (int i = 0; i < model->body_count; i++)
		mass += isfinite(model->mass[i]) ? model->mass[i] : 0;
	return sqrt(2 * mass * frame->numbers.kinetic_energy);
}

double rb_world_part_magnitude(int part, const struct rb_model *model, const struct rb_frame *frame)
{
	switch ((enum world_part)part) {
	case ENERGY:
	case KINETIC:
	case POTENTIAL:
		return fmax(frame->numbers.kinetic_energy, fabs(frame->numbers.potential_energy));
	case MOMENTUM:
		return momentum_bound(model, frame);
	case ANGULAR:
		return reach_of(model, frame) * momentum_bound(model, frame);
	case OVERLAP:
		return reach_of(model, frame);
	case COLLISIONS:
	case CONTACTS:
		break;
	}
	return 0;
}

bool rb_quantity_is_flat(double low, double high, double magnitude)
{
	/* conserved energies of runs vary by some 1e-14; what is told in 12 digits is told apart */
	static const double rounding = 1e-12;

	return high - low <= rounding * fmax(magnitude, fmax(fabs(low), fabs(high)));
}
