/* SPDX-License-Identifier: MIT */
/*
 * The tables from which the checks, the messages and the manual's lists of keys are made; AT is the
 * place of a key's value in the definition, HAND says that the call takes it itself. Tables are
 * chained by `more`: a plane's keys are its own and then those of any body. The order is that of
 * the manual.
 */
#include "script/rows.h"

#include <stdio.h>
#include <string.h>

#include <rbsim/scene.h>

#include "base/error.h"
#include "geom/mass.h"
#include "model/element.h"
#include "model/joint_type.h"

#define AT(type, member) offsetof(struct type, member)
#define HAND RB_ROW_BY_HAND
#define ROWS(array) array, (int)(sizeof(array) / sizeof *(array))

static const struct rb_row world_rows[] = {
	{"title", RB_ROW_TEXT, 0, 0, AT(rb_world_def, title), NULL, "none", "", "recorded"},
	{"description", RB_ROW_TEXT, 0, 0, AT(rb_world_def, description), NULL, "none", "",
         "recorded"},
	{"duration", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_world_def, duration_s), NULL,
         "required, here or on the command line", "s", "simulated time; or steps"},
	{"steps", RB_ROW_INTEGER, RB_RANGE_COUNT, 0, AT(rb_world_def, steps), NULL,
         "from the duration", "",
         "simulated time as a whole number of time_step; excludes duration"},
	{"frame_rate", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_world_def, frame_rate), NULL,
         "60", "1/s", "recorded frames per simulated second; frame 0 is the initial state"},
	{"time_step", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_world_def, time_step_s), NULL,
         "1/(4*frame_rate)", "s", "the longest step that the solver takes"},
	{"tolerance", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_world_def, tolerance_m), NULL,
         "see TOLERANCE", "m", "the largest overlap that a recorded frame may show"},
	{"gravity", RB_ROW_VECTOR, 0, 0, AT(rb_world_def, gravity), NULL, "{0, 0, 0}", "m/s^2",
         "an acceleration of every moving body"},
	{"gravity_force", RB_ROW_VECTOR, 0, 0, AT(rb_world_def, gravity_force), NULL, "none", "N",
         "the same force on every moving body"},
	{"gravitation", RB_ROW_TABLE, 0, 0, HAND, NULL, "none", "",
         "mutual gravitation of all bodies, see GRAVITATION; {} for the defaults"},
	{"rollback", RB_ROW_CHOICE, 0, 0, AT(rb_world_def, rollback), "selective, global, none",
         "selective", "",
         "what is undone when an overlap is found: the bodies concerned, the whole scene, nothing "
         "(the tolerance is then reported but not guaranteed)"},
	{"method", RB_ROW_CHOICE, 0, 0, AT(rb_world_def, method), RB_METHOD_NAMES, "auto", "",
         "how time is advanced; auto is located, or stepped if locating costs too much (see "
         "rbsim methods)"},
	{"seed", RB_ROW_SEED, 0, 0, AT(rb_world_def, seed), NULL, "1", "",
         "of math.random and all helpers; must be set before the first random number is drawn"},
	{"pause_on_collision", RB_ROW_BOOLEAN, 0, 0, AT(rb_world_def, pause_on_collision), NULL,
         "false", "", "playback in a console stops at each new collision"},
};

static const struct rb_row gravitation_rows[] = {
	{"G", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_gravitation_def, constant), NULL,
         "6.67430e-11", "m^3/(kg s^2)", "the constant of gravitation; CODATA 2018"},
	{"softening", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_gravitation_def, softening_m),
         NULL, "0", "m",
         "the potential of two bodies is -G m m'/sqrt(r^2 + softening^2) (Plummer)"},
	{"opening_angle", RB_ROW_NUMBER, RB_RANGE_UNIT, 0, AT(rb_gravitation_def, opening_angle),
         NULL, "0.5", "rad",
         "how coarsely steps may take distant groups of many bodies together: the sum of their "
         "sizes as a share of their distance; 0: pair by pair"},
};

static const struct rb_row material_rows[] = {
	{"name", RB_ROW_TEXT, 0, 0, AT(rb_material_def, name), NULL, "none", "",
         "unique; bodies may refer to it"},
	{"density", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_material_def, density), NULL, "1000",
         "kg/m^3", "density of a body that has neither mass nor density of its own"},
	{"friction", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_material_def, friction), NULL,
         "0.5", "1", "Coulomb's coefficient"},
	{"restitution", RB_ROW_NUMBER, RB_RANGE_UNIT, 0, AT(rb_material_def, restitution), NULL,
         "0", "1", "ratio of separation to approach speed in an impact"},
	{"color", RB_ROW_COLOR, 0, 0, AT(rb_material_def, color), NULL, "from a palette", "",
         "of the bodies made of it"},
	{"texture", RB_ROW_TEXTURE, 0, 0, AT(rb_material_def, texture),
         "checker, stripes, beachball, none", "none", "",
         "of the bodies made of it; see the key of the same name for bodies"},
	{"shininess", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_material_def, shininess), NULL,
         "spheres: 55, planes: 0", "",
         "how sharp highlights are (the exponent of Blinn and Phong); 0: none"},
};

static const struct rb_row contact_pair_rows[] = {
	{"friction", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_contact_pair_def, friction),
         NULL, "the geometric mean of the two", "1", "between the two materials"},
	{"restitution", RB_ROW_NUMBER, RB_RANGE_UNIT, 0, AT(rb_contact_pair_def, restitution), NULL,
         "the larger of the two", "1", "between the two materials"},
};

static const struct rb_row body_rows[] = {
	{"name", RB_ROW_TEXT, 0, 0, AT(rb_body_def, name), NULL, "none", "", "unique; recorded"},
	{"material", RB_ROW_MATERIAL, 0, 0, AT(rb_body_def, material), NULL, "a plain one", "",
         "a material or its name"},
	{"mass", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_body_def, mass), NULL,
         "from the density", "kg", "excludes density"},
	{"density", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_body_def, density), NULL,
         "of the material", "kg/m^3", "excludes mass"},
	{"center_of_mass", RB_ROW_VECTOR, 0, 0, AT(rb_body_def, center_of_mass), NULL,
         "the shape's centroid", "m", "in object coordinates; the shape stays where it is"},
	{"inertia", RB_ROW_INERTIA, 0, 0, AT(rb_body_given, inertia), NULL, "from shape and mass",
         "kg m^2", "about the centre of mass, object axes: {Ix, Iy, Iz} or three rows"},
	{"particles", RB_ROW_LIST, 0, 0, HAND, NULL, "none", "",
         "a list of point masses that determine mass, centre of mass and inertia, see below; "
         "excludes these and density"},
	{"position", RB_ROW_VECTOR, 0, 0, AT(rb_body_def, position), NULL, "{0, 0, 0}", "m",
         "of the object's origin"},
	{"orientation", RB_ROW_ORIENTATION, 0, 0, AT(rb_body_def, orientation), NULL,
         "{1, 0, 0, 0}", "", "{w, x, y, z} of unit length or {axis = {x, y, z}, angle = radians}"},
	{"velocity", RB_ROW_VECTOR, 0, 0, AT(rb_body_def, velocity), NULL, "{0, 0, 0}", "m/s",
         "of the centre of mass"},
	{"angular_velocity", RB_ROW_VECTOR, 0, 0, AT(rb_body_def, angular_velocity), NULL,
         "{0, 0, 0}", "rad/s", "about world axes"},
	{"static", RB_ROW_BOOLEAN, 0, 0, AT(rb_body_def, is_static), NULL,
         "false; planes without motion: true", "", "never moves"},
	{"motion", RB_ROW_FUNCTION, 0, 0, AT(rb_body_def, motion), NULL, "none", "",
         "of t: the position of a driven body, see MOTION; it pushes but is not pushed"},
	{"gravitational_mass", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0,
         AT(rb_body_def, gravitational_mass), NULL, "its mass; static and driven bodies: 0", "kg",
         "what it attracts others by if the world has gravitation; 0: a test body, which is only "
         "attracted"},
	{"forces", RB_ROW_LIST, 0, 0, HAND, NULL, "none", "", "a list of forces, see below"},
	{"group", RB_ROW_TEXT, 0, 0, HAND, NULL, "none", "", "collision group that it belongs to"},
	{"collides_with", RB_ROW_NAMES, 0, 0, HAND, NULL, "all", "",
         "the only groups that it can touch"},
	{"color", RB_ROW_COLOR, 0, 0, AT(rb_body_def, color), NULL, "of the material", "",
         "of its surface"},
	{"texture", RB_ROW_TEXTURE, 0, 0, AT(rb_body_def, texture),
         "checker, stripes, beachball, none", "of the material; spheres: beachball", "",
         "a pattern of its colour, or a PNG file in the scene's folder, see CAMERAS"},
	{"visible", RB_ROW_BOOLEAN, 0, 0, AT(rb_body_def, visible), NULL, "true", "",
         "drawn by cameras"},
};

static const struct rb_row plane_rows[] = {
	{"normal", RB_ROW_VECTOR, RB_RANGE_NOT_ZERO, 0, HAND, NULL, "{0, 0, 1}", "",
         "of any length; excludes orientation"},
	{"point", RB_ROW_VECTOR, 0, 0, HAND, NULL, "{0, 0, 0}", "m",
         "a point of it, its centre if finite; excludes "
         "position"},
	{"size", RB_ROW_NUMBERS, RB_RANGE_POSITIVE, 2, AT(rb_body_def, shape.size), NULL,
         "infinite", "m", "{w, h}: makes it finite"},
	{"axis", RB_ROW_VECTOR, RB_RANGE_NOT_ZERO, 0, HAND, NULL, "the world's x, else y", "",
         "the direction of w, projected on the plane"},
};

/* One of `shapes`: read as the body that it would be alone; keys of shapes stand before these. */
static const struct rb_row part_rows[] = {
	{"position", RB_ROW_VECTOR, 0, 0, AT(rb_body_def, position), NULL, "{0, 0, 0}", "m",
         "of its origin, in object coordinates of the body"},
	{"orientation", RB_ROW_ORIENTATION, 0, 0, AT(rb_body_def, orientation), NULL,
         "{1, 0, 0, 0}", "", "in object coordinates of the body"},
	{"density", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_body_def, density), NULL,
         "that of the body", "kg/m^3",
         "of this part; if the body has a mass, only the ratio to the other parts counts"},
};

static const struct rb_row force_rows[] = {
	{"vector", RB_ROW_VECTOR, 0, 0, AT(rb_force_def, vector), NULL,
         "required, or direction and magnitude, or torque", "N", ""},
	{"torque", RB_ROW_VECTOR, 0, 0, AT(rb_force_def, torque), NULL, "none", "N m",
         "with a vector or alone"},
	{"direction", RB_ROW_VECTOR, RB_RANGE_NOT_ZERO, 0, HAND, NULL, "none", "", "of any length"},
	{"magnitude", RB_ROW_NUMBER, 0, 0, HAND, NULL, "none", "N", "along the direction"},
	{"point", RB_ROW_VECTOR, 0, 0, AT(rb_force_def, point), NULL, "the centre of mass", "m",
         "where it acts, in object coordinates"},
	{"start", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_force_def, start_s), NULL, "0",
         "s", ""},
	{"duration", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_force_def, duration_s), NULL,
         "to the end", "s", ""},
	{"frame", RB_ROW_CHOICE, 0, 0, AT(rb_force_def, frame), "world, body", "world", "",
         "axes of the vector and the torque; those of the body turn with it"},
};

static const struct rb_row particle_rows[] = {
	{"mass", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_particle, mass), NULL, "required", "kg",
         ""},
	{"position", RB_ROW_VECTOR, 0, 0, AT(rb_particle, position), NULL, "required", "m",
         "in object coordinates, within the shape or not"},
};

static const struct rb_row camera_rows[] = {
	{"name", RB_ROW_TEXT, 0, 0, AT(rb_camera_def, name), NULL, "none", "",
         "unique; what --camera and messages call it"},
	{"position", RB_ROW_SOURCE, 0, 0, AT(rb_camera_def, position), NULL,
         "a place from which all moving bodies are visible over the whole film", "m",
         "a point, the origin of a body or a function of t"},
	{"look_at", RB_ROW_SOURCE, 0, 0, AT(rb_camera_def, look_at), NULL,
         "{0, 0, 0}; without position the middle of all moving bodies", "m",
         "the middle of the picture: a point, the origin of a body or a function of t"},
	{"up", RB_ROW_SOURCE, RB_RANGE_NOT_ZERO, 0, AT(rb_camera_def, up), NULL, "{0, 0, 1}", "",
         "the upward direction in the picture: a vector, the direction towards a body, or a "
         "function of t"},
	{"mount", RB_ROW_BODY, 0, 0, AT(rb_camera_def, mount), NULL, "none", "",
         "a body that carries the camera, instead of position; up turns with the body"},
	{"offset", RB_ROW_VECTOR, 0, 0, AT(rb_camera_def, offset), NULL, "{0, 0, 0}", "m",
         "from the mount, in its object coordinates"},
	{"level", RB_ROW_BOOLEAN, 0, 0, AT(rb_camera_def, level), NULL, "false", "",
         "offset and up do not turn with the mount"},
	{"fov", RB_ROW_NUMBER, RB_RANGE_FOV, 0, AT(rb_camera_def, fov), NULL, "deg(45)", "rad",
         "angle from the lower to the upper edge of the picture"},
	{"projection", RB_ROW_SWITCH, 0, 0, AT(rb_camera_def, orthographic),
         "perspective, orthographic", "perspective", "",
         "orthographic: lines of sight are parallel, so sizes do not depend on the distance; "
         "without near, bodies "
         "behind the camera are drawn too"},
	{"height", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_camera_def, height), NULL,
         "without position, as needed to show all moving bodies", "m",
         "of an orthographic picture, from the lower to the upper edge, instead of fov"},
	{"frustum", RB_ROW_NUMBERS, 0, 6, AT(rb_camera_def, frustum), NULL, "none", "m",
         "{left, right, bottom, top, near, far}: edges of the picture at the distance near, of an "
         "orthographic one at any distance; widened in pictures of another shape than size, by "
         "film or --size; excludes fov, height, near and far"},
	{"near", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_camera_def, near), NULL,
         "chosen for each picture", "m", "nothing nearer is drawn"},
	{"far", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_camera_def, far), NULL, "unlimited", "m",
         "nothing farther is drawn"},
	{"size", RB_ROW_INTEGERS, RB_RANGE_PIXELS, 2, AT(rb_camera_def, size_px), NULL,
         "{1280, 720}", "pixels", "{w, h}"},
	{"fps", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_camera_def, fps), NULL, "the frame rate",
         "1/s", "pictures per second of film"},
	{"speed", RB_ROW_RATE, RB_RANGE_POSITIVE, 0, HAND, NULL, "1", "",
         "simulated seconds in a second of film: 0.25 is slow motion, 10 time lapse; or a function "
         "of "
         "t that returns it"},
	{"from", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_camera_def, from_s), NULL, "0", "s",
         "simulated time of the first picture"},
	{"to", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_camera_def, to_s), NULL, "the end",
         "s", "simulated time after which there is no picture"},
	{"background", RB_ROW_COLOR, 0, 0, AT(rb_camera_def, background), NULL, "a sky", "",
         "one colour behind all bodies"},
	{"lights", RB_ROW_LIST, 0, 0, HAND, NULL, "a sun and a weak light from the opposite side",
         "", "a list of lights, see below, at most 8"},
	{"shadows", RB_ROW_BOOLEAN, 0, 0, AT(rb_camera_def, shadows), NULL, "true", "",
         "whether lights cast shadows; of the default lights only the sun does"},
	{"samples", RB_ROW_INTEGER, RB_RANGE_SAMPLES, 0, AT(rb_camera_def, samples), NULL, "4", "",
         "per pixel, against jagged edges"},
	{"overlay", RB_ROW_FLAGS, 0, 0, AT(rb_camera_def, overlay), "time, title, energy, scale",
         "none", "",
         "text over the picture: simulated time with the speed, title of the world, energies, a "
         "bar "
         "with its length at the distance of look_at; one or a list"},
	{"units", RB_ROW_TABLE, 0, 0, HAND, NULL, "by size", "",
         "in which the overlay tells lengths and times: {length = \"AU\", time = \"d\"}"},
	{"trails", RB_ROW_LIST, 0, 0, HAND, NULL, "none", "",
         "a list of bodies, or their names, whose paths since the start are drawn, at most 64"},
	{"labels", RB_ROW_LIST, 0, 0, HAND, NULL, "none", "",
         "a list of bodies, or their names, that are written above them, at most 64; {body, "
         "\"TEXT\"} for "
         "another text"},
	{"text", RB_ROW_TEXT, 0, 0, HAND, NULL, "none", "",
         "written over the picture: a text, a function of t that returns one, or a list of up to 8 "
         "of them, each also as {text, at = {x, y}, size = s}: at is its place in shares of the "
         "picture's width and height, from {0, 0}, the lower left corner, to {1, 1}, size the "
         "height of its lines as a share of the picture's height; without at, lines at the upper "
         "left corner"},
	{"plots", RB_ROW_LIST, 0, 0, HAND, NULL, "none", "",
         "up to 4 diagrams of a quantity against the time of the film, which grow with it: names "
         "of probes, or of what rbsim plot knows: energy, kinetic_energy, potential_energy, "
         "momentum, angular_momentum, collisions, contacts, max_penetration, BODY.z, BODY.speed, "
         "JOINT.angle and the like; each also as {NAME, at = {x, y}, size = {w, h}} in shares of "
         "the picture, at as for text; default: {0.3, 0.25} large or lower, so that all fit one "
         "above the other at the right"},
	{"vectors", RB_ROW_FLAGS, 0, 0, HAND,
         "velocity, contact, joint, spring, angular_velocity, acceleration, momentum, force",
         "none", "",
         "arrows over the picture: velocities of centres of mass, forces in lasting contacts, "
         "forces "
         "of joints and of springs on their b, angular velocities, accelerations, momenta, and the "
         "sum of the forces on each body; one or a list, each also as {NAME, bodies = {...}, scale "
         "= s}: of these bodies only, s metres long per SI unit; see Arrows"},
	{"style", RB_ROW_SWITCH, 0, 0, AT(rb_camera_def, wireframe), "shaded, wireframe", "shaded",
         "", "wireframe: lines that turn with the bodies"},
	{"png", RB_ROW_FILE, 0, 0, AT(rb_camera_def, png), NULL, "none", "",
         "pictures, with one %d for their number, which counts from 0: frames/%05d.png"},
	{"video", RB_ROW_FILE, 0, 0, AT(rb_camera_def, video), NULL, "none", "",
         "a film: .mp4, .webm or .gif, made by ffmpeg"},
};

static const struct rb_row film_rows[] = {
	{"name", RB_ROW_TEXT, 0, 0, AT(rb_camera_def, name), NULL, "none", "",
         "unique among films and cameras; what --camera and messages call it"},
	{"rows", RB_ROW_LIST, 0, 0, HAND, NULL, "required", "",
         "names of cameras, row by row from above: {{\"front\", \"top\"}, {\"ride\"}}; at most 16"},
	{"size", RB_ROW_INTEGERS, RB_RANGE_PIXELS, 2, AT(rb_camera_def, size_px), NULL,
         "{1280, 720}", "pixels",
         "{w, h} of the whole picture; rows share its height, cameras of a "
         "row its width"},
	{"fps", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_camera_def, fps), NULL,
         "that of the first camera", "1/s", "pictures per second of film"},
	{"speed", RB_ROW_RATE, RB_RANGE_POSITIVE, 0, HAND, NULL, "that of the first camera", "",
         "simulated seconds in a second of film, or a function of t that returns it"},
	{"from", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_camera_def, from_s), NULL,
         "that of the first camera", "s", "simulated time of the first picture"},
	{"to", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_camera_def, to_s), NULL,
         "that of the first camera", "s", "simulated time after which there is no picture"},
	{"png", RB_ROW_FILE, 0, 0, AT(rb_camera_def, png), NULL, "none", "",
         "pictures, with one %d for their number: frames/%05d.png"},
	{"video", RB_ROW_FILE, 0, 0, AT(rb_camera_def, video), NULL, "none", "",
         "a film: .mp4, .webm or .gif"},
};

static const struct rb_row units_rows[] = {
	{"length", RB_ROW_TEXT, 0, 0, HAND, NULL, "by size", "",
         "nm, um, mm, cm, m, km, R_moon, R_earth, R_jupiter, R_sun, AU, ly or pc; or {NAME, SIZE}, "
         "SIZE in the scene's metres"},
	{"time", RB_ROW_TEXT, 0, 0, HAND, NULL, "by size", "",
         "ns, us, ms, s, min, h, d, yr, kyr or Myr; or {NAME, SIZE}, SIZE in the scene's seconds"},
};

static const struct rb_row light_rows[] = {
	{"kind", RB_ROW_CHOICE, 0, 0, AT(rb_light_def, kind), "lamp, sun, spot, ambient",
         "lamp with position, sun with direction", "",
         "lamp: shines in all directions; sun: far away; spot: a lamp that lights a cone; ambient: "
         "from all directions, without shadows, instead of the light of the sky"},
	{"position", RB_ROW_VECTOR, 0, 0, AT(rb_light_def, position), NULL, "required", "m",
         "of a lamp or a spot"},
	{"direction", RB_ROW_VECTOR, RB_RANGE_NOT_ZERO, 0, AT(rb_light_def, position), NULL,
         "required", "", "towards a sun"},
	{"look_at", RB_ROW_VECTOR, 0, 0, AT(rb_light_def, look_at), NULL, "required", "m",
         "of a spot: a point on the axis of its cone"},
	{"angle", RB_ROW_NUMBER, RB_RANGE_FOV, 0, AT(rb_light_def, angle), NULL, "deg(30)", "rad",
         "of a spot: from the axis of its cone to the edge, beyond which it lights nothing"},
	{"softness", RB_ROW_NUMBER, RB_RANGE_UNIT, 0, AT(rb_light_def, softness), NULL, "0.2", "",
         "of a spot: the share of the angle over which its light fades out towards the edge; 0: a "
         "sharp edge"},
	{"color", RB_ROW_COLOR, 0, 0, AT(rb_light_def, color), NULL, "{1, 1, 1}", "",
         "of the light"},
	{"intensity", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_light_def, intensity), NULL,
         "1", "",
         "of a lamp or a spot: at the centre of the bodies at the start; it falls with the square "
         "of the distance"},
};

static const struct rb_row record_rows[] = {
	{"file", RB_ROW_FILE, 0, 0, AT(rb_record_def, file), NULL, "the scene's name with .h5", "",
         "name of the recording, in the folder where rbsim runs"},
	{"every", RB_ROW_INTEGER, RB_RANGE_COUNT, 0, AT(rb_record_def, every), NULL, "1", "frames",
         "record every n-th frame"},
	{"fields", RB_ROW_FLAGS, 0, 0, AT(rb_record_def, fields),
         "position, orientation, velocity, angular_velocity, contacts, events, acceleration, "
         "angular_acceleration, force, torque, joints, surfaces",
         "the first four; if there is a camera, events and what its arrows need", "",
         "what is recorded of each frame: one or a list, which replaces the default, or adds to it "
         "if its first entry is \"+\""},
	{"ledger", RB_ROW_BOOLEAN, 0, 0, AT(rb_record_def, ledger), NULL, "see LEDGER", "",
         "whether changes of energy and momentum are recorded by cause"},
	{"precision", RB_ROW_SWITCH, 0, 0, AT(rb_record_def, single_precision), "double, single",
         "double", "", ""},
	{"compression", RB_ROW_INTEGER, RB_RANGE_DIGIT, 0, AT(rb_record_def, compression), NULL,
         "0", "", "0 is none, 9 the most"},
};

/* Which of these a kind of joint has: rb_joint_keys. KINDS: those that it names. */
static const struct rb_row joint_rows[] = {
	{"kind", RB_ROW_CHOICE, 0, 0, AT(rb_joint_def, kind), RB_JOINT_KIND_NAMES, "required", "",
         "what it leaves free, see JOINTS"},
	{"name", RB_ROW_TEXT, 0, 0, AT(rb_joint_def, name), NULL, "none", "",
         "unique among joints; recorded"},
	{"a", RB_ROW_BODY, 0, 0, AT(rb_joint_def, a), NULL, "required", "", "a body or its name"},
	{"b", RB_ROW_BODY, 0, 0, AT(rb_joint_def, b), NULL, "the world", "",
         "another body or its name"},
	{"at", RB_ROW_VECTOR, 0, 0, AT(rb_joint_def, at), NULL,
         "required, or at_a or at_b; KINDS: the centre of mass of a", "m",
         "the point that a and b share, in world coordinates at the start; not of rods and ropes"},
	{"at_a", RB_ROW_VECTOR, 0, 0, AT(rb_joint_def, at_a), NULL,
         "from at or at_b; rod, rope: the centre of mass", "m",
         "the same point in object coordinates of a; of rods and ropes the end on a"},
	{"at_b", RB_ROW_VECTOR, 0, 0, AT(rb_joint_def, at_b), NULL,
         "from at or at_a; rod, rope: the centre of mass", "m",
         "in object coordinates of b, or in world coordinates if b is the world; of rods and ropes "
         "the end on b, required if that is the world"},
	{"axis", RB_ROW_VECTOR, RB_RANGE_NOT_ZERO, 0, AT(rb_joint_def, axis), NULL,
         "required: KINDS", "",
         "of turning or sliding, of any length, in world axes at the start; of a universal joint "
         "the axis that is fixed to a"},
	{"axis_b", RB_ROW_VECTOR, RB_RANGE_NOT_ZERO, 0, AT(rb_joint_def, axis_b), NULL,
         "required: KINDS", "", "the axis that is fixed to b, at right angles to axis"},
	{"length", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_joint_def, length_m), NULL,
         "the distance of its ends at the start", "m",
         "of a rod the distance of its ends, of a rope the largest"},
	{"limits", RB_ROW_LIST, 0, 0, HAND, NULL, "none", "rad or m",
         "{low, high}: the smallest and largest angle or way; both are 0 at the start, so low is "
         "at "
         "most 0 and high at least 0; -math.huge or math.huge: none on that side"},
	{"restitution", RB_ROW_NUMBER, RB_RANGE_UNIT, 0, AT(rb_joint_def, restitution), NULL, "0",
         "1", "at limits, and of a rope that comes taut"},
	{"friction", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_joint_def, friction), NULL, "0",
         "N m or N", "the largest torque, or force, with which it resists motion"},
	{"motor", RB_ROW_LIST, 0, 0, HAND, NULL, "none", "", "a table, see below"},
	{"stiffness", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_joint_def, stiffness), NULL,
         "0", "N m/rad or N/m", "of a spring for the angle or the way"},
	{"damping", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_joint_def, damping), NULL, "0",
         "N m s/rad or N s/m", "torque or force per speed, against it"},
	{"rest", RB_ROW_NUMBER, 0, 0, AT(rb_joint_def, rest), NULL, "0", "rad or m",
         "angle or way at which its spring exerts nothing"},
	{"collides", RB_ROW_BOOLEAN, 0, 0, AT(rb_joint_def, collides), NULL, "false", "",
         "whether a and b touch each other"},
	{"visible", RB_ROW_BOOLEAN, 0, 0, AT(rb_joint_def, visible), NULL, "true", "",
         "drawn by cameras: rods as bars, ropes as cords, sliders on springs as coils, hinges and "
         "other joints as pins"},
	{"radius", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_joint_def, radius_m), NULL,
         "from the sizes of its bodies", "m", "of what is drawn"},
	{"color", RB_ROW_COLOR, 0, 0, AT(rb_joint_def, color), NULL, "grey; ropes: brown", "",
         "of what is drawn"},
};

/* `motor` of a joint, and the argument of set_motor. */
static const struct rb_row motor_rows[] = {
	{"speed", RB_ROW_NUMBER, 0, 0, AT(rb_joint_def, motor_speed), NULL,
         "required, or angle or way", "rad/s or m/s", "the motor keeps this speed"},
	{"angle", RB_ROW_FUNCTION, 0, 0, AT(rb_joint_def, motor_function), NULL, "none", "",
         "of a joint with an angle: a function of t that returns the angle, rad, that it follows, "
         "0 at the start, and perhaps its speed"},
	{"way", RB_ROW_FUNCTION, 0, 0, AT(rb_joint_def, motor_function), NULL, "none", "",
         "the same of a joint with a way, m"},
	{"torque", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_joint_def, motor_max), NULL,
         "required, if the joint has an angle", "N m", "the most that it exerts"},
	{"force", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(rb_joint_def, motor_max), NULL,
         "required, if the joint has a way", "N", "the most that it exerts"},
};

/* The last argument of field. */
static const struct rb_row field_rows[] = {
	{"potential", RB_ROW_FUNCTION, 0, 0, AT(rb_field_def, potential), NULL, "none", "J",
         "of t, x and body: the energy of which the force is the gradient, with the sign changed"},
};

/* The last argument of param. */
static const struct rb_row param_rows[] = {
	{"min", RB_ROW_NUMBER, 0, 0, AT(rb_param_def, min), NULL, "none", "",
         "the smallest value allowed"},
	{"max", RB_ROW_NUMBER, 0, 0, AT(rb_param_def, max), NULL, "none", "",
         "the largest value allowed"},
	{"choices", RB_ROW_LIST, 0, 0, HAND, NULL, "any", "", "a list of the values allowed"},
};

static const struct rb_row measure_rows[] = {
	{"unit", RB_ROW_TEXT, 0, 0, AT(rb_measure_def, units), NULL, "none", "",
         "shown after the number and recorded; a text like \"m/s\""},
	{"description", RB_ROW_TEXT, 0, 0, AT(rb_measure_def, description), NULL, "none", "",
         "recorded"},
};

const struct rb_row_table rb_rows_world = {"world", ROWS(world_rows), NULL};
const struct rb_row_table rb_rows_gravitation = {"gravitation", ROWS(gravitation_rows), NULL};
const struct rb_row_table rb_rows_material = {"material", ROWS(material_rows), NULL};
const struct rb_row_table rb_rows_contact_pair = {"contact_pair", ROWS(contact_pair_rows), NULL};
const struct rb_row_table rb_rows_body = {"body", ROWS(body_rows), NULL};
const struct rb_row_table rb_rows_plane = {"plane", ROWS(plane_rows), &rb_rows_body};
static const struct rb_row_table rows_part = {"shapes", ROWS(part_rows), NULL};
const struct rb_row_table rb_rows_force = {"forces", ROWS(force_rows), NULL};
const struct rb_row_table rb_rows_particle = {"particles", ROWS(particle_rows), NULL};
const struct rb_row_table rb_rows_camera = {"camera", ROWS(camera_rows), NULL};
const struct rb_row_table rb_rows_film = {"film", ROWS(film_rows), NULL};
const struct rb_row_table rb_rows_units = {"units", ROWS(units_rows), NULL};
const struct rb_row_table rb_rows_light = {"lights", ROWS(light_rows), NULL};
const struct rb_row_table rb_rows_record = {"record", ROWS(record_rows), NULL};
const struct rb_row_table rb_rows_field = {"field", ROWS(field_rows), NULL};
const struct rb_row_table rb_rows_joint = {"joint", ROWS(joint_rows), NULL};
const struct rb_row_table rb_rows_motor = {"motor", ROWS(motor_rows), NULL};
const struct rb_row_table rb_rows_param = {"param", ROWS(param_rows), NULL};
const struct rb_row_table rb_rows_measure = {"result", ROWS(measure_rows), NULL};

const struct rb_row *rb_row_find(const struct rb_row_table *table, const char *key, int *index)
{
	int first = 0;

	for (; table; table = table->more) {
		for (int i = 0; i < table->count; i++) {
			/* most differ in the first byte, which costs no call */
			if (table->rows[i].key[0] != key[0] || strcmp(table->rows[i].key, key) != 0)
				continue;
			if (index)
				*index = first + i;
			return &table->rows[i];
		}
		first += table->count;
	}
	return NULL;
}

const char *rb_range_text(enum rb_row_range range)
{
	static const char *const texts[RB_RANGE_KIND_COUNT] = {
		[RB_RANGE_ANY] = "",
		[RB_RANGE_POSITIVE] = "positive",
		[RB_RANGE_NOT_NEGATIVE] = "0 or more",
		[RB_RANGE_UNIT] = "in [0, 1]",
		[RB_RANGE_SHARE] = "above 0 and at most 1",
		[RB_RANGE_NOT_ZERO] = "not zero",
		[RB_RANGE_DIGIT] = "in [0, 9]",
		[RB_RANGE_PIXELS] = "in [1, 16384]",
		[RB_RANGE_SAMPLES] = "in [1, 64]",
		[RB_RANGE_COUNT] = "1 or more",
		[RB_RANGE_FOV] = "between 0 and pi, in radians: deg(45)",
	};

	RB_ASSERT(range < RB_RANGE_KIND_COUNT);
	return texts[range];
}

size_t rb_choice_at(const char *choices, int k, const char **name)
{
	RB_ASSERT(k >= 0 && name);
	while (choices && *choices) {
		const size_t size = strcspn(choices, ",");
		if (k-- == 0) {
			*name = choices;
			return size;
		}
		choices += size;
		choices += strspn(choices, ", ");
	}
	*name = "";
	return 0;
}

static const char *const type_texts[RB_ROW_TYPE_COUNT] = {
	[RB_ROW_NUMBER] = "number",
	[RB_ROW_INTEGER] = "integer",
	[RB_ROW_SEED] = "integer, 0 or more",
	[RB_ROW_BOOLEAN] = "boolean",
	[RB_ROW_TEXT] = "text",
	[RB_ROW_FILE] = "path",
	[RB_ROW_TEXTURE] = "text",
	[RB_ROW_VECTOR] = "vector",
	[RB_ROW_NUMBERS] = "numbers",
	[RB_ROW_INTEGERS] = "integers",
	[RB_ROW_ORIENTATION] = "orientation",
	[RB_ROW_COLOR] = "color",
	[RB_ROW_CHOICE] = "one of",
	[RB_ROW_SWITCH] = "one of",
	[RB_ROW_FLAGS] = "some of",
	[RB_ROW_MATERIAL] = "material",
	[RB_ROW_BODY] = "body",
	[RB_ROW_FUNCTION] = "function",
	[RB_ROW_SOURCE] = "vector, body or function",
	[RB_ROW_RATE] = "number or function",
	[RB_ROW_INERTIA] = "three numbers or three rows",
	[RB_ROW_LIST] = "list",
	[RB_ROW_NAMES] = "text or list of texts",
	[RB_ROW_TABLE] = "table of keys",
};

/* Prints an mdoc item; a '.' or a quote at the start of a line would be a request. */
static void print_row(FILE *file, const struct rb_row *row)
{
	RB_ASSERT(row->type < RB_ROW_TYPE_COUNT);
	fprintf(file, ".It Ic %s\n%s", row->key, type_texts[row->type]);
	if (row->choices)
		fprintf(file, "%s %s", row->type == RB_ROW_TEXTURE ? ", a file or one of" : "",
		        row->choices);
	if (row->range != RB_RANGE_ANY)
		fprintf(file, ", %s", rb_range_text(row->range));
	if (*row->unit && strcmp(row->unit, "1") != 0)
		fprintf(file, ", %s", row->unit);
	if (*row->help)
		fprintf(file, ": %s", row->help);
	fprintf(file, ".\nDefault: %s.\n", row->fallback);
}

/* Prints a table as an mdoc list between the marks by which the manual's check finds it. */
static void print_table(FILE *file, const struct rb_row_table *table)
{
	fprintf(file, ".\\\" table %s\n.Bl -tag -width Ds -compact\n", table->name);
	for (int i = 0; i < table->count; i++)
		print_row(file, &table->rows[i]);
	fprintf(file, ".El\n.\\\" end\n");
}

/* ---- of joints ---- */

/* The key of some kinds, with these in its default. */
static void print_joint_row(FILE *file, const struct rb_row *row)
{
	static const char mark[] = "KINDS";
	const char *const at = strstr(row->fallback, mark);
	char kinds[RB_JOINT_KINDS_SIZE] = "", text[RB_JOINT_KINDS_SIZE + 80];
	struct rb_row named = *row;

	for (int k = 0; at && k < rb_joint_key_count; k++)
		if (strcmp(rb_joint_keys[k].key, row->key) == 0)
			(void)rb_joint_list_kinds(rb_joint_keys[k].named, ", ", kinds);
	if (at)
		snprintf(text, sizeof text, "%.*s%s%s", (int)(at - row->fallback), row->fallback,
		         kinds, at + strlen(mark));
	named.fallback = at ? text : row->fallback;
	print_row(file, &named);
}

static void print_joint(FILE *file)
{
	fprintf(file, ".\\\" table %s\n.Bl -tag -width Ds -compact\n", rb_rows_joint.name);
	for (int i = 0; i < rb_rows_joint.count; i++)
		print_joint_row(file, &rb_rows_joint.rows[i]);
	fprintf(file, ".El\n.\\\" end\n");
}

/* ---- of shapes ---- */

struct rb_row_table rb_rows_shape(const struct rb_shape_type *type)
{
	return (struct rb_row_table){type->name, type->key, type->key_count, &rb_rows_body};
}

/* Place of a key among the rows so far; their count where it is new. */
static int find_row(const struct rb_part_rows *rows, const char *key)
{
	int at = 0;

	while (at < rows->count && strcmp(rows->row[at].key, key) != 0)
		at++;
	return at;
}

/* Adds the keys of one type of part, or its name to the help of a key that others have too. */
static void add_shape(struct rb_part_rows *rows, const struct rb_shape_type *type)
{
	const size_t used = strlen(rows->choices);

	snprintf(rows->choices + used, sizeof rows->choices - used, "%s%s", used > 0 ? ", " : "",
	         type->name);
	for (int k = 0; k < type->key_count; k++) {
		const int at = find_row(rows, type->key[k].key);

		RB_ASSERT(at < RB_PART_KEYS_MAX);
		char *const help = rows->help[at];
		const size_t told = at < rows->count ? strlen(help) : 0;
		snprintf(help + told, sizeof rows->help[at] - told, "%s a %s",
		         told > 0 ? "," : "of", type->name);
		if (at < rows->count)
			continue;
		rows->row[at] = type->key[k];
		rows->row[at].help = help;
		rows->count++;
	}
}

void rb_rows_part(struct rb_part_rows *rows)
{
	rows->choices[0] = '\0';
	rows->row[0] = (struct rb_row){"shape",
	                               RB_ROW_CHOICE,
	                               0,
	                               0,
	                               HAND,
	                               rows->choices,
	                               "required",
	                               "",
	                               "what it is; it takes the keys of such a body"};
	rows->count = 1;
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		if (rb_shape_types[k]->is_part)
			add_shape(rows, rb_shape_types[k]);
	rows->table = (struct rb_row_table){rows_part.name, rows->row, rows->count, &rows_part};
}

/* Prints the keys of each shape, then those of parts of unions. */
static void print_shapes(FILE *file)
{
	struct rb_part_rows part;

	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++) {
		const struct rb_row_table table = rb_rows_shape(rb_shape_types[k]);

		if (k == RB_SHAPE_PLANE)
			print_table(file, &rb_rows_plane);
		else if (table.count > 0)
			print_table(file, &table);
	}
	rb_rows_part(&part);
	fprintf(file, ".\\\" table %s\n.Bl -tag -width Ds -compact\n", part.table.name);
	for (int i = 0; i < part.table.count; i++)
		print_row(file, &part.row[i]);
	for (int i = 0; i < rows_part.count; i++)
		print_row(file, &rows_part.rows[i]);
	fprintf(file, ".El\n.\\\" end\n");
}

void rb_fields_print(FILE *file)
{
	static const struct rb_row_table *const before[] = {
		&rb_rows_world, &rb_rows_gravitation, &rb_rows_material, &rb_rows_contact_pair};
	static const struct rb_row_table *const after[] = {
		&rb_rows_body,  &rb_rows_force, &rb_rows_particle, &rb_rows_camera,
		&rb_rows_film,  &rb_rows_units, &rb_rows_light,    &rb_rows_record,
		&rb_rows_param, &rb_rows_field, &rb_rows_measure};

	for (size_t t = 0; t < sizeof before / sizeof *before; t++)
		print_table(file, before[t]);
	print_shapes(file);
	for (size_t t = 0; t < sizeof after / sizeof *after; t++)
		print_table(file, after[t]);
	print_joint(file);
	print_table(file, &rb_rows_motor);
	for (int place = 0; place < rb_element_kind_count; place++)
		print_table(file, &rb_element_kinds[place]->keys);
}
