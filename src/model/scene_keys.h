/* SPDX-License-Identifier: MIT */
/*
 * What a key of the scene language is: type, range, default, unit, help, and where its value goes.
 *
 * Calls of the language (script/rows) and kinds of force elements (model/element) have tables of
 * them. A row whose value needs more than a type has no place (`at` is RB_ROW_BY_HAND): the call
 * reads it itself.
 */
#ifndef RB_MODEL_SCENE_KEYS_H
#define RB_MODEL_SCENE_KEYS_H

#include <stddef.h>
#include <stdint.h>

enum rb_row_type {
	RB_ROW_NUMBER,      /* double */
	RB_ROW_INTEGER,     /* int */
	RB_ROW_SEED,        /* uint64_t */
	RB_ROW_BOOLEAN,     /* bool */
	RB_ROW_TEXT,        /* const char *, borrowed from the value */
	RB_ROW_FILE,        /* const char *: a path within the folder of the outputs */
	RB_ROW_TEXTURE,     /* const char *: a built-in name or a PNG file beside the scene */
	RB_ROW_VECTOR,      /* rb_vec3 */
	RB_ROW_NUMBERS,     /* double[count] */
	RB_ROW_INTEGERS,    /* int[count] */
	RB_ROW_ORIENTATION, /* rb_quat */
	RB_ROW_COLOR,       /* double[3] */
	RB_ROW_CHOICE,      /* int (an enum): the place in `choices` */
	RB_ROW_SWITCH,      /* bool: the second of two choices */
	RB_ROW_FLAGS,       /* unsigned: bit k for choices[k]; one text or a list */
	RB_ROW_MATERIAL,    /* int: a material or its name */
	RB_ROW_BODY,        /* int: a body or its name */
	RB_ROW_FUNCTION,    /* int: the script's number of it */
	RB_ROW_SOURCE,      /* struct rb_camera_vector: a vector, a body or a function */
	RB_ROW_RATE,        /* read by hand: a number or a function */
	RB_ROW_INERTIA,     /* rb_mat3: three numbers or three rows of them */
	RB_ROW_LIST,        /* by hand */
	RB_ROW_NAMES,       /* by hand: a text or a list of texts */
	RB_ROW_TABLE,       /* by hand: a table of keys of its own */
	RB_ROW_TYPE_COUNT
};

enum rb_row_range {
	RB_RANGE_ANY,
	RB_RANGE_POSITIVE,
	RB_RANGE_NOT_NEGATIVE,
	RB_RANGE_UNIT,     /* [0, 1] */
	RB_RANGE_SHARE,    /* (0, 1] */
	RB_RANGE_NOT_ZERO, /* a vector with a length */
	RB_RANGE_DIGIT,    /* [0, 9] */
	RB_RANGE_PIXELS,   /* [1, 16384] */
	RB_RANGE_SAMPLES,  /* [1, 64] */
	RB_RANGE_COUNT,    /* 1 or more */
	RB_RANGE_FOV,      /* (0, pi) */
	RB_RANGE_KIND_COUNT
};

#define RB_ROW_BY_HAND SIZE_MAX

struct rb_row {
	const char *key;
	enum rb_row_type type;
	enum rb_row_range range;
	int count;           /* of RB_ROW_NUMBERS and RB_ROW_INTEGERS */
	size_t at;           /* offset in the definition */
	const char *choices; /* "a, b, c" */
	const char *fallback, *unit, *help;
};

struct rb_row_table {
	const char *name; /* the call */
	const struct rb_row *rows;
	int count;
	const struct rb_row_table *more; /* rows shared with others, after its own; may be NULL */
};

#endif
