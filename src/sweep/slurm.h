/* SPDX-License-Identifier: MIT */
/*
 * A sweep as a job array of Slurm: a script in the folder of the sweep, handed over with sbatch(1),
 * which no shell of ours stands before. What the jobs need is in the folder and in this program.
 */
#ifndef RB_SWEEP_SLURM_H
#define RB_SWEEP_SLURM_H

#include "sweep/folder.h"

#define RB_SLURM_SCRIPT "sweep.sbatch"
enum { RB_SLURM_ID_SIZE = 64 };

/* All borrowed; texts that are NULL are left to Slurm's own defaults. */
struct rb_slurm_order {
	const char *folder;        /* absolute */
	const char *name;          /* of the job */
	uint64_t tasks;            /* of the array */
	int jobs, threads;         /* runs at a time in a task; threads of each */
	double checkpoint_every_s; /* NAN: as runs do by themselves */
	const char *time, *memory, *partition;
	const char *const *options; /* further ones of sbatch */
	int option_count;
};

/*
 * How many tasks an array may have here: MaxArraySize of the cluster, Slurm's default where it does
 * not tell.
 */
uint64_t rb_slurm_tasks_max(void);
/* Writes the script; an older one is replaced. RB_ERR_USAGE where an option can't stand in it. */
RB_CHECKED enum rb_status rb_slurm_write(const struct rb_slurm_order *order, struct rb_error *err);
/* How many tasks the script in a folder parts the sweep into; 0: there is none. */
uint64_t rb_slurm_tasks(const char *folder);
/*
 * Hands the script over with these tasks of it, "3,7-9". RB_ERR_MISSING with sbatch's words where
 * that fails.
 */
RB_CHECKED enum rb_status rb_slurm_submit(const char *folder, const char *array,
                                          char id[RB_SLURM_ID_SIZE], struct rb_error *err);

#endif
