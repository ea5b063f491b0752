/* SPDX-License-Identifier: MIT */
/* src/sweep/slurm.c: the script of a job array, and what sbatch and scontrol say, by stand-ins */
#include "support.h"

#include <fcntl.h>
#include <sys/stat.h>

#include "sweep/slurm.h"

/* A folder with programs that stand before those of the machine in PATH. */
struct place {
	char folder[256], programs[280];
	char *path_before;
	struct rb_error err;
};

static const char *path_in(const char *folder, const char *name)
{
	static char path[RB_FOLDER_PATH_SIZE];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static void open_place(struct place *place)
{
	*place = (struct place){0};
	support_folder(place->folder);
	snprintf(place->programs, sizeof place->programs, "%s/bin", place->folder);
	assert_int_equal(mkdir(place->programs, 0700), 0);
	place->path_before = rb_memory_copy_text(getenv("PATH"));
	setenv("PATH", place->programs, 1);
}

static void close_place(struct place *place)
{
	static const char *const names[] = {RB_SLURM_SCRIPT, "bin/sbatch", "bin/scontrol", "words",
	                                    "bin"};

	setenv("PATH", place->path_before, 1);
	rb_memory_free(place->path_before);
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		(void)remove(path_in(place->folder, names[i]));
	assert_int_equal(rmdir(place->folder), 0);
}

/* A program of the shell; its words are kept in the file `words` of the folder where it runs. */
static void put_program(const struct place *place, const char *name, const char *text)
{
	char whole[1000];
	const int size = snprintf(whole, sizeof whole, "#!/bin/sh\n%s\n", text);
	const int file = open(path_in(place->programs, name),
	                      O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0700);

	assert_true(file >= 0);
	assert_int_equal(write(file, whole, (size_t)size), size);
	assert_int_equal(close(file), 0);
}

static struct rb_slurm_order order_of(const struct place *place)
{
	return (struct rb_slurm_order){.folder = place->folder,
	                               .name = "a sweep",
	                               .tasks = 12,
	                               .jobs = 3,
	                               .threads = 2,
	                               .checkpoint_every_s = (double)NAN};
}

/* The script, to be freed. */
static char *script_of(const struct place *place)
{
	struct rb_error err;
	char *text;
	size_t size;

	assert_ok(rb_folder_read(path_in(place->folder, RB_SLURM_SCRIPT), 100000, &text, &size,
	                         &err));
	return text;
}

static void assert_line(const char *text, const char *line)
{
	char whole[400];

	snprintf(whole, sizeof whole, "\n%s\n", line);
	if (!strstr(text, whole))
		fail_msg("no line '%s' in\n%s", line, text);
}

static void the_script_asks_for_what_was_ordered(void **state)
{
	static const char *const options[] = {"--account=x", "-C", "--exclude=\"a b\""};
	struct place place;
	struct rb_error err;

	(void)state;
	open_place(&place);
	struct rb_slurm_order order = order_of(&place);
	order.time = "1-00:00:00";
	order.memory = "4G";
	order.partition = "long one";
	order.options = options;
	order.option_count = 3;
	order.checkpoint_every_s = 0.1;
	assert_ok(rb_slurm_write(&order, &err));
	char *text = script_of(&place);
	assert_memory_equal(text, "#!/bin/sh\n", 10);
	static const char *const lines[] = {"#SBATCH --job-name=\"a sweep\"",
	                                    "#SBATCH --array=0-11",
	                                    "#SBATCH --ntasks=1",
	                                    "#SBATCH --cpus-per-task=6",
	                                    "#SBATCH --time=1-00:00:00",
	                                    "#SBATCH --mem=4G",
	                                    "#SBATCH --partition=\"long one\"",
	                                    "#SBATCH --signal=B:USR1@60",
	                                    "#SBATCH --requeue",
	                                    "#SBATCH --account=x",
	                                    "#SBATCH -C",
	                                    "#SBATCH --exclude=\"a b\"",
	                                    "tasks=12"};
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
		assert_line(text, lines[i]);
	assert_non_null(strstr(text, " --jobs 3 --threads 2 --checkpoint-every 0.1"));
	/* sbatch reads no directive behind the first command */
	const char *last = NULL;
	for (const char *at = text; (at = strstr(at, "#SBATCH")); at++)
		last = at;
	assert_true(last < strstr(text, "\ntasks="));
	rb_memory_free(text);

	/* an older one is replaced, and what is not asked for is left to Slurm */
	order = order_of(&place);
	order.tasks = 1;
	assert_ok(rb_slurm_write(&order, &err));
	text = script_of(&place);
	assert_line(text, "#SBATCH --array=0-0");
	assert_null(strstr(text, "--time"));
	assert_null(strstr(text, "--mem"));
	assert_null(strstr(text, "--partition"));
	assert_null(strstr(text, "--checkpoint-every"));
	rb_memory_free(text);
	close_place(&place);
}

static void a_shell_takes_the_script_and_finds_the_program(void **state)
{
	struct place place;
	struct rb_error err;
	char command[1300], program[600] = "", wanted[600];

	(void)state;
	open_place(&place);
	const struct rb_slurm_order order = order_of(&place);
	assert_ok(rb_slurm_write(&order, &err));
	snprintf(command, sizeof command, "/bin/sh -n '%s/%s'", place.folder, RB_SLURM_SCRIPT);
	assert_int_equal(system(command), 0);
	/* the lines before the call, and what they have set */
	snprintf(command, sizeof command,
	         "sed '/^\"$rbsim\"/,$d' '%s/%s' >'%s/words'; echo 'echo \"$rbsim\"' "
	         ">>'%s/words'; /bin/sh '%s/words'",
	         place.folder, RB_SLURM_SCRIPT, place.folder, place.folder, place.folder);
	setenv("PATH", place.path_before, 1);
	FILE *said = popen(command, "r");
	assert_non_null(said);
	assert_non_null(fgets(program, sizeof program, said));
	assert_int_equal(pclose(said), 0);
	program[strcspn(program, "\n")] = '\0';
	const ssize_t size = readlink("/proc/self/exe", wanted, sizeof wanted - 1);
	assert_true(size > 0);
	wanted[size] = '\0';
	assert_string_equal(program, wanted);
	close_place(&place);
}

static void options_that_cannot_stand_in_it_are_refused(void **state)
{
	static const char *const wrong[] = {"account=x", "", "x --y"};
	struct place place;

	(void)state;
	open_place(&place);
	struct rb_slurm_order order = order_of(&place);
	order.option_count = 1;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		order.options = &wrong[i];
		assert_int_equal(rb_slurm_write(&order, &place.err), RB_ERR_USAGE);
		assert_non_null(strstr(place.err.text, "does not begin with '-'"));
	}
	static const char *const line = "--account=x\nrm -rf ~";
	order.options = &line;
	assert_int_equal(rb_slurm_write(&order, &place.err), RB_ERR_USAGE);
	assert_string_equal(place.err.text, "option '--slurm-option' holds a control character");
	order.option_count = 0;
	order.time = "1\n2";
	assert_int_equal(rb_slurm_write(&order, &place.err), RB_ERR_USAGE);
	assert_string_equal(place.err.text, "option '--time' holds a control character");
	order.time = NULL;
	order.memory = "4G\r";
	assert_int_equal(rb_slurm_write(&order, &place.err), RB_ERR_USAGE);
	order.memory = NULL;
	order.partition = "\x1b[2J";
	assert_int_equal(rb_slurm_write(&order, &place.err), RB_ERR_USAGE);
	assert_string_equal(place.err.text, "option '--partition' holds a control character");
	assert_int_equal(access(path_in(place.folder, RB_SLURM_SCRIPT), F_OK), -1);
	close_place(&place);
}

static void the_number_of_tasks_is_read_from_the_script(void **state)
{
	static const struct {
		const char *text;
		uint64_t tasks;
	} cases[] = {{"#!/bin/sh\ntasks=7\n", 7},
	             {"#!/bin/sh\ntasks=10000000\n", 10000000},
	             {"#!/bin/sh\ntasks=10000001\n", 0},
	             {"#!/bin/sh\n# tasks=7\n", 0},
	             {"", 0},
	             {"\ntasks=x", 0}};
	struct place place;
	struct rb_error err;

	(void)state;
	open_place(&place);
	assert_int_equal(rb_slurm_tasks(place.folder), 0);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		FILE *file = fopen(path_in(place.folder, RB_SLURM_SCRIPT), "w");
		assert_non_null(file);
		fputs(cases[i].text, file);
		fclose(file);
		assert_int_equal(rb_slurm_tasks(place.folder), cases[i].tasks);
	}
	struct rb_slurm_order order = order_of(&place);
	for (order.tasks = 1; order.tasks < 2000000; order.tasks *= 17) {
		assert_ok(rb_slurm_write(&order, &err));
		assert_int_equal(rb_slurm_tasks(place.folder), order.tasks);
	}
	close_place(&place);
}

static void the_job_goes_to_sbatch_and_its_number_comes_back(void **state)
{
	static const char *const said[][2] = {
		{"echo 4711", "4711"},
		{"echo '4711;cluster'", "4711"},
		{"echo 'sbatch: warning: 3 nodes' >&2; echo 12", "12"},
		{"printf 12", NULL}, /* without a line break: it is one all the same */
	};
	struct place place;
	struct rb_error err;
	char id[RB_SLURM_ID_SIZE], text[300];
	size_t size;
	char *words;

	(void)state;
	open_place(&place);
	for (size_t i = 0; i < sizeof said / sizeof *said; i++) {
		snprintf(text, sizeof text, "echo \"$# $*\" >words\n%s", said[i][0]);
		put_program(&place, "sbatch", text);
		assert_ok(rb_slurm_submit(place.folder, "3,7-9", id, &err));
		assert_string_equal(id, said[i][1] ? said[i][1] : "12");
		/* in the folder of the sweep, each word one */
		assert_ok(
			rb_folder_read(path_in(place.folder, "words"), 1000, &words, &size, &err));
		assert_string_equal(words, "3 --parsable --array=3,7-9 " RB_SLURM_SCRIPT "\n");
		rb_memory_free(words);
	}
	close_place(&place);
}

static void what_sbatch_says_against_it_is_told(void **state)
{
	struct place place;
	char id[RB_SLURM_ID_SIZE];

	(void)state;
	open_place(&place);
	assert_int_equal(rb_slurm_submit(place.folder, "0", id, &place.err), RB_ERR_MISSING);
	assert_non_null(strstr(place.err.text, "there is no 'sbatch' in PATH"));
	assert_non_null(strstr(place.err.text, place.folder));
	assert_string_equal(id, "");
	put_program(&place, "sbatch", "echo 'invalid account' >&2; echo more >&2; exit 1");
	assert_int_equal(rb_slurm_submit(place.folder, "0", id, &place.err), RB_ERR_MISSING);
	assert_string_equal(place.err.text, "sbatch refused the job: invalid account");
	put_program(&place, "sbatch", "echo 12; exit 1");
	assert_int_equal(rb_slurm_submit(place.folder, "0", id, &place.err), RB_ERR_MISSING);
	assert_string_equal(id, "");
	put_program(&place, "sbatch", "exit 0");
	assert_int_equal(rb_slurm_submit(place.folder, "0", id, &place.err), RB_ERR_MISSING);
	assert_string_equal(place.err.text, "sbatch refused the job: it said nothing");
	/* more than anybody wants to read, and it does not wait for a reader */
	put_program(&place, "sbatch",
	            "i=0; while [ $i -lt 20000 ]; do echo 'many words'; "
	            "i=$((i + 1)); done; exit 1");
	assert_int_equal(rb_slurm_submit(place.folder, "0", id, &place.err), RB_ERR_MISSING);
	assert_string_equal(place.err.text, "sbatch refused the job: many words");
	rb_memory_fail_at(1);
	const enum rb_status status = rb_slurm_submit(place.folder, "0", id, &place.err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	close_place(&place);
}

static void the_largest_array_is_what_the_cluster_says(void **state)
{
	struct place place;

	(void)state;
	open_place(&place);
	assert_int_equal(rb_slurm_tasks_max(), 1001); /* of slurm.conf(5) */
	put_program(&place, "scontrol",
	            "[ \"$*\" = 'show config' ] && echo 'MaxArraySize            = 50000'");
	assert_int_equal(rb_slurm_tasks_max(), 50000);
	put_program(&place, "scontrol", "echo 'MaxArraySize = 50000'; exit 1");
	assert_int_equal(rb_slurm_tasks_max(), 1001);
	put_program(&place, "scontrol", "echo 'MaxArraySize = none'");
	assert_int_equal(rb_slurm_tasks_max(), 1001);
	put_program(&place, "scontrol", "echo 'MaxJobCount = 7'");
	assert_int_equal(rb_slurm_tasks_max(), 1001);
	close_place(&place);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_script_asks_for_what_was_ordered),
		cmocka_unit_test(a_shell_takes_the_script_and_finds_the_program),
		cmocka_unit_test(options_that_cannot_stand_in_it_are_refused),
		cmocka_unit_test(the_number_of_tasks_is_read_from_the_script),
		cmocka_unit_test(the_job_goes_to_sbatch_and_its_number_comes_back),
		cmocka_unit_test(what_sbatch_says_against_it_is_told),
		cmocka_unit_test(the_largest_array_is_what_the_cluster_says),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
