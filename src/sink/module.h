/* SPDX-License-Identifier: MIT */
/*
 * What is heavy and not always needed lives in modules of their own, loaded when a run or a verb
 * needs them: the HDF5 side in rbsim-hdf5.so (recording, reading recordings), pictures and video in
 * rbsim-film.so (OSMesa or EGL, libpng, FreeType), the console's screen in rbsim-console.so
 * (ncurses). Linking them would cost every start some milliseconds and tens of megabytes.
 *
 * Each is loaded once (later calls return the same table); RB_ERR_MISSING says which file was
 * looked for and why it could not be loaded.
 */
#ifndef RB_SINK_MODULE_H
#define RB_SINK_MODULE_H

#include <stdbool.h>

#include <rbsim/scene.h>
#include <rbsim/sink.h>

#include "flow/run_info.h"

struct rb_recorder_options {
	const char *path; /* final name */
	unsigned
		/*
		 * of base/place: whether an existing file may be replaced, and whose word the name
		 * is
		 */
		how;
	double flush_s; /* longest wall time between flushes; 0: one second */
	/*
	 * a recording that is there goes on after `row_count` of its frames, the last of them
	 * `frame`
	 */
	bool resume;
	uint64_t row_count, frame;
	/* with `resume`: nothing is known of how the run ended but what the file says */
	bool repair;
};

struct rb_recorder;
struct rb_reader;

/* What a recording says of itself; texts are owned by the reader. */
struct rb_reading {
	int body_count, static_count;
	int driven_count;                         /* of the bodies */
	int element_counts[RB_ELEMENT_KINDS_MAX]; /* of the scene: springs, drag, ... */
	int field_count;
	/* of joints, their kinds and names, "" where one has none: [joint_count]; 0: NULL */
	int joint_count;
	const int *joint_kind;
	const char **joint_names;
	int shape_counts[RB_SHAPE_KIND_COUNT]; /* bodies of each kind of shape */
	uint64_t frame_count;
	const char *status, *reason, *state_hash, *started, *ended;
	const char *version, *build, *command, *host, *method, *rollback, *title;
	uint64_t seed;
	int threads;
	double time_step_s, tolerance_m, frame_rate, duration_s;
	double stepped_tolerance_m; /* of frames that were stepped */
	unsigned fields;            /* RB_FIELD_* that are stored per frame */
	const char **names; /* [body_count + static_count], by id, "" where a body has none */
	const int *id;      /* [body_count]: moving bodies */
	int param_count;
	const char **param_names, **param_values;
	int file_count;
	const char **file_names, **file_texts; /* [0] is the scene; zero-terminated */
	const size_t *file_sizes;              /* bytes; textures hold zero bytes */
	uint64_t event_count;
	int result_count, probe_count; /* of the scene; results are NAN until the run has ended */
	const char **result_names, **result_units, **probe_names, **probe_units;
	const double *results;
};

/* A table in memory (sweep/table): columns of numbers, NAN where there is none, or of texts. */
struct rb_table_column {
	const char *group; /* "parameters" and the like */
	char *units;       /* owned; NULL: none */
	char *name;        /* owned */
	double *numbers;   /* owned: [rows]; NULL: texts */
	char **texts;      /* owned, each too: [rows] */
};
struct rb_table {
	uint64_t rows;
	struct rb_table_column *columns; /* owned */
	int column_count;
	bool *has_recording; /* owned: [rows] */
};

/* Many recordings as one file; all borrowed. */
struct rb_collection {
	const char *path;
	bool replace;
	const char *version, *scene;
	const struct rb_table *table;
	/*
	 * Name of a row's recording, as it is found from here and from the folder of `path`; hold
	 * until the next call.
	 */
	const char *(*file)(void *user, uint64_t row);
	const char *(*link)(void *user, uint64_t row);
	void *user;
};

/* A column of a collected sweep; borrowed. */
struct rb_column_name {
	const char *file, *group, *name;
};
enum { RB_COLUMN_UNITS_SIZE = RB_MEASURE_UNITS_MAX + 1 };

/* The module's one exported object is `const struct rb_hdf5_module rb_hdf5_module`. */
struct rb_hdf5_module {
	int version; /* RB_HDF5_MODULE_VERSION of the build */

	/*
	 * The recorder is a sink; the row in `sink` borrows the recorder, which the sink's owner
	 * destroys after closing.
	 */
	enum rb_status (*recorder_create)(struct rb_recorder **recorder, struct rb_sink *sink,
	                                  const struct rb_run_info *info,
	                                  const struct rb_recorder_options *options,
	                                  struct rb_error *err);
	void (*recorder_destroy)(struct rb_recorder *recorder);
	/*
	 * Any thread: the file is to hold every frame up to this one soon; and waits until it does,
	 * false when it never will. Between the recorder's making and its end.
	 */
	void (*recorder_ask)(struct rb_recorder *recorder, uint64_t frame);
	bool (*recorder_wait)(struct rb_recorder *recorder, uint64_t frame);
	/* Bytes that a whole run's recording will take (for `rbsim check`). */
	uint64_t (*recorder_estimate)(const struct rb_run_info *info);

	/*
	 * RB_ERR_INPUT when it can't be opened or is no recording of ours. Works on one that is
	 * still growing or was cut off.
	 */
	enum rb_status (*reader_open)(struct rb_reader **reader, const char *path,
	                              struct rb_error *err);
	void (*reader_close)(struct rb_reader *reader);
	const struct rb_reading *(*reader_reading)(const struct rb_reader *reader);
	/* Looks again at a growing recording: updates frame_count and status. */
	enum rb_status (*reader_refresh)(struct rb_reader *reader, struct rb_error *err);
	/* The frame's columns belong to the reader and hold until the next call. */
	enum rb_status (*reader_frame)(struct rb_reader *reader, uint64_t row,
	                               struct rb_frame *frame, struct rb_error *err);
	/*
	 * A per-frame observable "kinetic_energy", "probes/NAME", ...: `values` has room for
	 * frame_count * width doubles.
	 */
	enum rb_status (*reader_observable)(struct rb_reader *reader, const char *name, int width,
	                                    double *values, struct rb_error *err);
	/* Units of an observable, "" of a pure number or where there is none; the reader's. */
	const char *(*reader_units)(const struct rb_reader *reader, const char *name);
	/* One file of virtual datasets over them; `*linked` receives how many. */
	enum rb_status (*collect)(const struct rb_collection *collection, uint64_t *linked,
	                          struct rb_error *err);
	/*
	 * A column of numbers in such a file, to be freed; RB_ERR_INPUT where there is none.
	 * `units` (may be NULL) has room for RB_COLUMN_UNITS_SIZE bytes.
	 */
	enum rb_status (*column)(const struct rb_column_name *column, double **values,
	                         uint64_t *count, char *units, struct rb_error *err);

	/* Names and versions of the libraries underneath, as they are loaded: "HDF5 1.10.8". */
	void (*libraries)(char *out, size_t size);
};

enum { RB_HDF5_MODULE_VERSION = 6 };

RB_CHECKED enum rb_status rb_module_hdf5(const struct rb_hdf5_module **module,
                                         struct rb_error *err);

/* ---- pictures and video ---- */

struct rb_pixmap; /* film/pixmap.h */
struct rb_png_text;

/* A part of a picture that several cameras share: `size_px` is that of the part. */
struct rb_film_cell {
	struct rb_camera_def camera;
	int at_px[2]; /* of its upper left corner */
};

struct rb_film_options {
	const struct rb_model *model; /* borrowed, with its scene, until the film is destroyed */
	const struct rb_camera_def
		*camera; /* borrowed; `png` and `video` are the outputs, from the current folder */
	/* borrowed: the cameras of a picture that is divided; 0: `camera` has it all */
	const struct rb_film_cell *cells;
	int cell_count;
	bool still; /* one picture, to `png` as it is, without a number */
	/*
	 * Of the camera among those filmed: that of its shots. Cell c of picture k has the shot k *
	 * cell_count + c.
	 */
	int number;
	double end_s;        /* when the run ends */
	unsigned how;        /* of base/place: whose word its files' names are */
	double patience_s;   /* with an encoder that hangs; 0: as usual */
	int encoder_threads; /* that make PNG files besides the one that draws; 0: one */
	const char *command; /* for the text chunks of pictures; may be NULL */
};

/* What a film has done and where its wall time went; complete after the sink was closed. */
struct rb_film_tally {
	uint64_t pictures;      /* drawn and written */
	uint64_t picture_count; /* of the whole film */
	uint64_t left_out;      /* while it was switched off */
	uint64_t bytes;         /* of all files */
	uint64_t draw_ns, read_ns, png_ns,
		pipe_ns;  /* GL; its pixels; PNG files; video down the pipe */
	uint64_t wait_ns; /* the drawing thread for the encoding one */
};

struct rb_film;
struct rb_take;

/* The module's one exported object is `const struct rb_film_module rb_film_module`. */
struct rb_film_module {
	int version; /* RB_FILM_MODULE_VERSION of the build */

	/* Can this film be made? Textures, font, ffmpeg, outputs; leaves nothing behind. */
	enum rb_status (*film_check)(const struct rb_film_options *options, struct rb_error *err);
	/* The row in `sink` borrows the film, which the sink's owner destroys after closing. */
	enum rb_status (*film_create)(struct rb_film **film, struct rb_sink *sink,
	                              const struct rb_film_options *options, struct rb_error *err);
	void (*film_destroy)(struct rb_film *film);
	/*
	 * From any thread: no picture after the one that is being drawn; what was printed becomes
	 * the film.
	 */
	void (*film_cut)(struct rb_film *film);
	/* film/film.h: pictures of moments after `time_s` are left out, or drawn again. */
	enum rb_status (*film_switch)(struct rb_film *film, double time_s, bool on,
	                              struct rb_error *err);
	struct rb_film_tally (*film_tally)(const struct rb_film *film);

	/*
	 * Single pictures: film/take.h, film/png.h. `picture` borrows the take's memory until the
	 * next call.
	 */
	enum rb_status (*take_create)(struct rb_take **take, const struct rb_model *model,
	                              const struct rb_camera_def *camera, struct rb_error *err);
	void (*take_destroy)(struct rb_take *take);
	void (*take_see)(struct rb_take *take, const struct rb_frame *frame);
	enum rb_status (*take_draw)(struct rb_take *take, const struct rb_frame *frame,
	                            const struct rb_frame_shot *shot, struct rb_pixmap *picture,
	                            struct rb_error *err);
	enum rb_status (*png_write)(const char *path, unsigned how, const struct rb_pixmap *pixmap,
	                            const struct rb_png_text *texts, size_t *bytes,
	                            struct rb_error *err);

	/* Names and versions of the libraries underneath, as they are loaded: "HDF5 1.10.8". */
	void (*libraries)(char *out, size_t size);
};

enum { RB_FILM_MODULE_VERSION = 6 };

RB_CHECKED enum rb_status rb_module_film(const struct rb_film_module **module,
                                         struct rb_error *err);
/* false: this program was built without films (WITH_FILM=0), so that the above fails. */
bool rb_module_has_film(void);

/* ---- the console's screen ---- */

struct rb_viewer; /* control/viewer.h */

/* The module's one exported object is `const struct rb_console_module rb_console_module`. */
struct rb_console_module {
	int version; /* RB_CONSOLE_MODULE_VERSION of the build */

	/* control/desk.h: keys in, screen out, until the viewer wishes for something else. */
	enum rb_status (*run)(struct rb_viewer *viewer, int listen, int *signal,
	                      struct rb_error *err);

	/* Names and versions of the libraries underneath, as they are loaded: "HDF5 1.10.8". */
	void (*libraries)(char *out, size_t size);
};

enum { RB_CONSOLE_MODULE_VERSION = 3 };

RB_CHECKED enum rb_status rb_module_console(const struct rb_console_module **module,
                                            struct rb_error *err);

#endif
