/* SPDX-License-Identifier: MIT */
/*
 * A scene run from C, and its recording read back:
 *
 *     cc embed.c $(pkg-config --cflags --libs rbsim) -o embed
 *     ./embed scene.lua BODY run.h5 [NAME=VALUE...]
 *
 * Prints time and height of one body at every frame, and compares the recording with what it has
 * seen.
 */
#include <rbsim.h>

#include <stdio.h>

static int fail(const struct rbsim_error *error)
{
	fprintf(stderr, "embed: %s\n", error->text);
	return error->status;
}

/* Largest difference, m, of the body's recorded height at the last frame from `height`. */
static int compare(const char *path, const char *name, double height, struct rbsim_error *error)
{
	struct rbsim_recording *recording;
	const struct rbsim_frame *frame;

	if (rbsim_recording_open(&recording, path, error))
		return error->status;
	const uint64_t rows = rbsim_recording_frame_count(recording);
	const int body = rbsim_recording_find(recording, name);
	if (!rbsim_recording_frame(recording, rows - 1, &frame, error))
		printf("recorded: %llu frames, %s, the last one off by %g m\n",
		       (unsigned long long)rows, rbsim_recording_status(recording),
		       frame->position[3 * body + 2] - height);
	rbsim_recording_close(recording);
	return error->status;
}

int main(int argc, char **argv)
{
	if (argc < 4) {
		fprintf(stderr, "usage: embed SCENE.lua BODY RUN.h5 [NAME=VALUE...]\n");
		return RBSIM_USAGE;
	}
	const struct rbsim_options options = {.size = sizeof options,
	                                      .record = argv[3],
	                                      .params = (const char *const *)argv + 4,
	                                      .param_count = argc - 4};
	struct rbsim_simulation *simulation;
	struct rbsim_error error;

	if (rbsim_open(&simulation, argv[1], &options, &error))
		return fail(&error);
	const int body = rbsim_find(simulation, argv[2]);
	if (body < 0) {
		fprintf(stderr, "embed: '%s' has no body '%s' that moves\n", argv[1], argv[2]);
		rbsim_close(simulation);
		return RBSIM_USAGE;
	}
	const struct rbsim_frame *const now = rbsim_frame(simulation);
	do
		printf("%.17g %.17g\n", now->time_s, now->position[3 * body + 2]);
	while (!rbsim_is_over(simulation) && !rbsim_step(simulation, &error));

	const double height = now->position[3 * body + 2];
	const int written = !error.status && !rbsim_finish_recording(simulation, &error);
	rbsim_close(simulation);
	return written && !compare(argv[3], argv[2], height, &error) ? 0 : fail(&error);
}
