/* SPDX-License-Identifier: MIT */
/*
 * How fast the recorder is, against a plain H5Dwrite of the same bytes: bench_recorder FOLDER. One line of JSON per
 * number of bodies; frames are filled beforehand, everything stays in the page cache. Best of three.
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <hdf5.h>

#include "base/clock.h"
#include "h5support.h"

static double seconds(uint64_t from)
{
	return 1e-9 * (double)(rb_clock_now_ns() - from);
}

static void must(bool good, const char *what)
{
	if (good)
		return;
	fprintf(stderr, "bench_recorder: %s failed\n", what);
	exit(1);
}

/* Seconds for all frames, from open to close. */
static double time_recorder(const char *path, int bodies, uint64_t frames, int compression,
                            double *size)
{
	struct fake fake;
	struct stat found;

	fake_init(&fake, bodies, frames, true);
	fake.scene.record.compression = compression;
	(void)fake_frame(&fake, 1);
	fake.frame.event_count = fake.frame.contact_count = 0;
	const uint64_t start = rb_clock_now_ns();
	must(fake_open(&fake, path, true, NULL) == RB_OK, "open");
	for (uint64_t k = 0; k < frames; k++) {
		fake.frame.index = k;
		must(fake.sink.frame(fake.sink.self, &fake.frame, NULL) == RB_OK, "frame");
	}
	must(fake_close(&fake, RB_OK, NULL) == RB_OK, "close");
	const double took = seconds(start);
	must(stat(path, &found) == 0, "stat");
	*size = (double)found.st_size;
	unlink(path);
	fake_release(&fake);
	return took;
}

/* The same columns in the plainest way: a chunk a frame, old format, no flush, no reader. */
static double time_plain(const char *path, int bodies, uint64_t frames)
{
	static const char *const names[] = {"a", "b", "c", "d"};
	static const hsize_t width[] = {3, 4, 3, 3};
	double *const cells = calloc((size_t)bodies * 4, sizeof *cells);
	hid_t dataset[4];

	for (int i = 0; i < bodies * 4; i++)
		cells[i] = 0.125 * i;
	const uint64_t start = rb_clock_now_ns();
	const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
	for (int c = 0; c < 4; c++) {
		const hsize_t size[3] = {0, (hsize_t)bodies, width[c]},
			      most[3] = {H5S_UNLIMITED, size[1], size[2]};
		const hid_t space = H5Screate_simple(3, size, most);
		const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
		H5Pset_chunk(properties, 3, (const hsize_t[]){1, size[1], size[2]});
		dataset[c] = H5Dcreate2(file, names[c], H5T_NATIVE_DOUBLE, space, H5P_DEFAULT,
		                        properties, H5P_DEFAULT);
		H5Pclose(properties);
		H5Sclose(space);
	}
	for (uint64_t k = 0; k < frames; k++)
		for (int c = 0; c < 4; c++) {
			const hsize_t at[3] = {k, 0, 0}, size[3] = {1, (hsize_t)bodies, width[c]};
			H5Dset_extent(dataset[c], (const hsize_t[]){k + 1, size[1], size[2]});
			const hid_t space = H5Dget_space(dataset[c]),
				    memory = H5Screate_simple(3, size, NULL);
			H5Sselect_hyperslab(space, H5S_SELECT_SET, at, NULL, size, NULL);
			must(H5Dwrite(dataset[c], H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT,
			              cells) >= 0,
			     "H5Dwrite");
			H5Sclose(memory);
			H5Sclose(space);
		}
	for (int c = 0; c < 4; c++)
		H5Dclose(dataset[c]);
	must(H5Fclose(file) >= 0, "H5Fclose");
	const double took = seconds(start);
	unlink(path);
	free(cells);
	return took;
}

int main(int count, char **arguments)
{
	static const struct {
		int bodies;
		uint64_t frames;
		int compression;
	} cases[] = {{1, 300000, 0},  {10, 300000, 0}, {1000, 5000, 0},
	             {10000, 500, 0}, {100000, 50, 0}, {10000, 30, 1}};
	char path[512];

	snprintf(path, sizeof path, "%s/bench-recorder-%ld.h5", count > 1 ? arguments[1] : ".",
	         (long)getpid());
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		double best = 1e9, plain = 1e9, size = 0;
		for (int k = 0; k < 3; k++) {
			const double took = time_recorder(path, cases[i].bodies, cases[i].frames,
			                                  cases[i].compression, &size);
			best = took < best ? took : best;
			if (cases[i].compression == 0) {
				const double other = time_plain(path, cases[i].bodies,
				                                cases[i].frames);
				plain = other < plain ? other : plain;
			}
		}
		const double bytes = 104.0 * cases[i].bodies * (double)cases[i].frames;
		printf("{\"bench\": \"recorder\", \"bodies\": %d, \"frames\": %llu, "
		       "\"compression\": %d, \"MB_s\": %.0f, "
		       "\"us_frame\": %.2f, \"file_of_data\": %.3f",
		       cases[i].bodies, (unsigned long long)cases[i].frames, cases[i].compression,
		       bytes / best * 1e-6, best / (double)cases[i].frames * 1e6, size / bytes);
		if (cases[i].compression == 0)
			printf(", \"plain_MB_s\": %.0f, \"against_plain\": %.2f",
			       bytes / plain * 1e-6, plain / best);
		printf("}\n");
		fflush(stdout);
	}
	return 0;
}
