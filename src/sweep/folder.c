/* SPDX-License-Identifier: MIT */
/*
 * plan.csv is written last and under its name only when whole, so its presence means that all
 * copies are there: two sweeps that start on one folder at once both write equal copies, one of
 * them publishes the plan, the other one finds it and checks that it is its own. Every later use
 * compares the copies' hashes with the plan's, because a result must not silently belong to a scene
 * that has been edited.
 *
 * Loading parses the head into the same wish that a command line gives and plans again; the plan's
 * own lines are then compared with the file. So there is one reader of values, and a damaged head
 * cannot pass.
 */
#include "sweep/folder.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "geom/meshfile.h"

/* 1 GiB: a scene's file may be a texture, but a larger one is not to be taken into memory. */
static const size_t file_bytes_max = (size_t)1 << 30;

/* ---- names ---- */

enum rb_status rb_folder_name(const char *folder, const char *name, char out[RB_FOLDER_PATH_SIZE],
                              struct rb_error *err)
{
	const int length = snprintf(out, RB_FOLDER_PATH_SIZE, "%s/%s", folder, name);

	if (length < 0 || length >= RB_FOLDER_PATH_SIZE)
		return RB_FAIL(err, RB_ERR_CREATE, "the name '%s' is too long", folder);
	return RB_OK;
}

const char *rb_folder_path(const struct rb_plan *plan, const char *folder, uint64_t index,
                           const char *ending, char out[RB_FOLDER_PATH_SIZE])
{
	/*
	 * five digits at least, so that listings of usual sweeps look alike; more where indices
	 * have them
	 */
	const int digits = plan->count > 100000 ? snprintf(NULL, 0, "%" PRIu64, plan->count - 1)
	                                        : 5;

	snprintf(out, RB_FOLDER_PATH_SIZE, "%s%spoint-%0*" PRIu64 "%s", folder ? folder : "",
	         folder ? "/" : "", digits, index, ending);
	return out;
}

/* Whether the name is that of a picture or a mesh, by its ending; a module has none. */
static bool is_asset(const char *name)
{
	const size_t size = strlen(name);

	return (size > 4 && strcasecmp(name + size - 4, ".png") == 0) ||
	       rb_meshfile_kind(name) != RB_MESHFILE_NONE;
}

/*
 * Name within the sweep's folder of the copy of a file of the scene: modules as Lua's require finds
 * them (dots become folders). False: it has none, since its name leads out of the scene's folder;
 * only its hash is kept then.
 */
static bool copy_name(const char *name, bool is_scene, char out[RB_FOLDER_PATH_SIZE])
{
	const bool shipped = strncmp(name, "rbsim.", 6) == 0;

	if (is_scene || is_asset(name)) {
		const size_t parts = strlen(name);
		for (const char *at = name; at && at < name + parts;
		     at = strchr(at, '/') ? strchr(at, '/') + 1 : NULL)
			if (*at == '/' || strncmp(at, "../", 3) == 0 || strcmp(at, "..") == 0)
				return false;
		snprintf(out, RB_FOLDER_PATH_SIZE, "scene/%s", name);
		return true;
	}
	const int length = snprintf(out, RB_FOLDER_PATH_SIZE, "%s/%s", shipped ? "lua" : "scene",
	                            name);
	for (char *c = out; *c; c++)
		if (*c == '.')
			*c = '/';
	snprintf(out + length, RB_FOLDER_PATH_SIZE - (size_t)length, ".lua");
	return true;
}

/* ---- reading ---- */

enum rb_status rb_folder_read(const char *path, size_t most, char **text, size_t *size,
                              struct rb_error *err)
{
	struct stat about;
	FILE *const file = fopen(path, "re");

	*text = NULL;
	*size = 0;
	if (!file)
		return RB_FAIL(err, RB_ERR_INPUT, "cannot open '%s': %s", path, strerror(errno));
	/* a pipe or device could block or never end */
	if (fstat(fileno(file), &about) != 0 || !S_ISREG(about.st_mode) ||
	    (uint64_t)about.st_size > most) {
		fclose(file);
		return RB_FAIL(err, RB_ERR_INPUT,
		               "cannot read '%s': it is not a file, or too large", path);
	}
	*text = rb_memory_take((size_t)about.st_size + 1, 1);
	if (!*text) {
		fclose(file);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", path);
	}
	*size = fread(*text, 1, (size_t)about.st_size, file);
	(*text)[*size] = '\0';
	fclose(file);
	return RB_OK;
}

bool rb_folder_has_plan(const char *folder)
{
	char path[RB_FOLDER_PATH_SIZE];

	return rb_folder_name(folder, RB_FOLDER_PLAN, path, NULL) == RB_OK &&
	       access(path, F_OK) == 0;
}

/*
 * Reads the lines of plan.csv that begin with '#' into `*head`, owned by the caller: each ended by
 * a zero, with an empty one behind. Lines may be longer than one read.
 */
static enum rb_status read_head(const char *path, char **head, struct rb_error *err)
{
	size_t size = 0, capacity = 0;
	char part[4096];
	bool begins = true, inside = false;
	FILE *const file = fopen(path, "re");

	*head = NULL;
	if (!file)
		return RB_FAIL(err, RB_ERR_INPUT, "cannot open '%s': %s", path, strerror(errno));
	while (fgets(part, sizeof part, file)) {
		if (begins)
			inside = *part == '#';
		if (!inside)
			break;
		const size_t length = strcspn(part, "\n");
		begins = part[length] == '\n';
		if (!rb_memory_reserve(head, &capacity, size + length + 2, 1)) {
			fclose(file);
			return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", path);
		}
		memcpy(*head + size, part, length);
		size += length;
		if (begins)
			(*head)[size++] = '\0';
		(*head)[size] = '\0';
	}
	fclose(file);
	if (size == 0)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' is not the plan of a sweep", path);
	return RB_OK;
}

/* ---- the plan of a folder ---- */

/*
 * What a head says, as if it were a command line; texts are borrowed from the text that was read.
 */
struct head {
	struct rb_plan_wish wish;
	const char **params, **words;
	struct rb_source_file *files;
	int file_count;
};

/* The value of the line "# KEY VALUE"; NULL: it has another key. */
static const char *value_of(const char *line, const char *key)
{
	const size_t size = strlen(key);

	if (strncmp(line, "# ", 2) != 0 || strncmp(line + 2, key, size) != 0 ||
	    line[2 + size] != ' ')
		return NULL;
	return line + 3 + size;
}

/*
 * Takes one line of a head; unknown keys are skipped here and found by the comparison that follows.
 */
static void take_line(struct head *head, const char *line)
{
	struct rb_plan_wish *const wish = &head->wish;
	const char *value;

	if ((value = value_of(line, "sweep of rbsim")))
		wish->version = value;
	else if ((value = value_of(line, "scene")))
		wish->scene = value;
	else if ((value = value_of(line, "param")))
		head->params[wish->param_count++] = value;
	else if ((value = value_of(line, "option")))
		head->words[wish->word_count++] = value;
	else if ((value = value_of(line, "sample")))
		wish->sample = value;
	else if ((value = value_of(line, "seeds")))
		wish->seeds = strtoull(value, NULL, 10);
	else if ((value = value_of(line, "seed")))
		wish->base_seed = strtoull(value, NULL, 10);
	else if ((value = value_of(line, "recordings")))
		wish->records = *value == 'y';
	else if ((value = value_of(line, "films")))
		wish->films = *value == 'y';
	/* 64 hexadecimal digits of SHA-256, a space, a name */
	else if ((value = value_of(line, "file")) && strlen(value) > 65) {
		struct rb_source_file *const file = &head->files[head->file_count++];
		memcpy(file->sha256, value, 64);
		file->name = value + 65;
	}
}

/*
 * Plans again what the head says. Errors of usage become errors of input, because the user has not
 * given these words now. `plan` is to be released in any case.
 */
static enum rb_status take_head(struct rb_plan *plan, const char *text, const char *path,
                                const char *version, struct rb_error *err)
{
	struct head head = {0};
	size_t lines = 1;

	for (const char *line = text; *line; line += strlen(line) + 1)
		lines++;
	head.params = rb_memory_take(lines, sizeof *head.params);
	head.words = rb_memory_take(lines, sizeof *head.words);
	head.files = rb_memory_take(lines, sizeof *head.files);
	enum rb_status status = RB_OK;
	if (!head.params || !head.words || !head.files)
		status = RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", path);
	for (const char *line = text; !status && *line; line += strlen(line) + 1)
		take_line(&head, line);
	head.wish.params = head.params;
	head.wish.words = head.words;
	if (!status && (!head.wish.version || !head.wish.scene || head.wish.seeds == 0 ||
	                head.wish.seeds > RB_PLAN_POINTS_MAX || head.file_count == 0))
		status = RB_FAIL(err, RB_ERR_INPUT, "'%s' is not the plan of a sweep", path);
	if (!status && strcmp(head.wish.version, version) != 0)
		status = RB_FAIL(err, RB_ERR_INPUT,
		                 "'%s' is of rbsim %.20s, this is %s: their runs would not compare",
		                 path, head.wish.version, version);
	if (!status) {
		status = rb_plan_init(plan, &head.wish, head.files, head.file_count, err);
		if (status == RB_ERR_USAGE)
			err->status = status = RB_ERR_INPUT;
	}
	rb_memory_free(head.params);
	rb_memory_free(head.words);
	rb_memory_free(head.files);
	return status;
}

/* Compares the hashes of the copies with the plan's. */
static enum rb_status check_copies(const char *folder, const struct rb_plan *plan,
                                   struct rb_error *err)
{
	enum rb_status status = RB_OK;

	for (int i = 0; i < plan->file_count && !status; i++) {
		char name[RB_FOLDER_PATH_SIZE], path[RB_FOLDER_PATH_SIZE], hex[65];
		char *text;
		size_t size;
		if (!copy_name(plan->files[i].name, i == 0, name))
			continue;
		status = rb_folder_name(folder, name, path, err);
		if (!status)
			status = rb_folder_read(path, file_bytes_max, &text, &size, err);
		if (status)
			break;
		rb_hash_sha256(text, size, hex);
		rb_memory_free(text);
		if (strcmp(hex, plan->files[i].sha256) != 0)
			status = RB_FAIL(err, RB_ERR_INPUT,
			                 "'%s' has changed since the sweep began", path);
	}
	return status;
}

enum rb_status rb_folder_load(const char *folder, struct rb_plan *plan, const char *version,
                              struct rb_error *err)
{
	char path[RB_FOLDER_PATH_SIZE];
	char *head = NULL;

	*plan = (struct rb_plan){0};
	enum rb_status status = rb_folder_name(folder, RB_FOLDER_PLAN, path, err);
	if (!status)
		status = read_head(path, &head, err);
	if (!status)
		status = take_head(plan, head, path, version, err);
	rb_memory_free(head);
	if (!status)
		status = rb_folder_check(folder, plan, false, err);
	if (!status)
		status = check_copies(folder, plan, err);
	return status;
}

/* ---- is it the same? ---- */

/*
 * Says how two lines differ, for people; NULL: the line is missing. A scene's file that has changed
 * has a message of its own, as the usual case. Always fails.
 */
static enum rb_status differs(const char *path, const char *found, const char *wanted,
                              struct rb_error *err)
{
	const char *const file = wanted ? value_of(wanted, "file") : NULL;

	RB_ASSERT(found || wanted);
	if (file && found && value_of(found, "file") &&
	    strcmp(file + 64, value_of(found, "file") + 64) == 0)
		return RB_FAIL(err, RB_ERR_INPUT,
		               "'%s' is of another sweep: '%.80s' has changed since (-o takes "
		               "another folder)",
		               path, file + 65);
	return RB_FAIL(err, RB_ERR_INPUT,
	               "'%s' is of another sweep: it has '%.60s' where this one has '%.60s' (-o "
	               "takes another folder)",
	               path, found ? found : "", wanted ? wanted : "");
}

/*
 * Fails unless the next line of the file is `wanted`. `line`: room for the longest that may come,
 * and a line break; a longer one is cut there and differs.
 */
static enum rb_status compare_line(FILE *file, const char *path, const char *wanted, char *line,
                                   size_t room, struct rb_error *err)
{
	RB_ASSERT(room > strlen(wanted) + 1);
	if (!fgets(line, (int)room, file))
		return differs(path, NULL, wanted, err);
	line[strcspn(line, "\n")] = '\0';
	return strcmp(line, wanted) == 0 ? RB_OK : differs(path, line, wanted, err);
}

/*
 * Compares the head, the titles and, with `rows`, all rows of a file with a plan, and with `rows`
 * that nothing follows.
 */
static enum rb_status compare(FILE *file, const char *path, const struct rb_plan *plan, bool rows,
                              struct rb_error *err)
{
	size_t room = plan->row_size;
	enum rb_status status = RB_OK;

	for (int i = 0; i < plan->line_count; i++)
		if (strlen(plan->lines[i]) + 3 > room)
			room = strlen(plan->lines[i]) + 3;
	char *const line = rb_memory_take(room + 2, 1), *const row = rb_memory_take(room, 1);
	if (!line || !row)
		status = RB_FAIL(err, RB_ERR_MEMORY, "cannot check '%s': out of memory", path);
	for (int i = 0; i < plan->line_count && !status; i++)
		status = compare_line(file, path, plan->lines[i], line, room + 2, err);
	if (!status) {
		rb_plan_titles(plan, row);
		status = compare_line(file, path, row, line, room + 2, err);
	}
	for (uint64_t i = 0; rows && i < plan->count && !status; i++) {
		rb_plan_row(plan, i, row);
		status = compare_line(file, path, row, line, room + 2, err);
	}
	if (!status && rows && fgets(line, (int)room + 2, file))
		status = differs(path, line, NULL, err);
	rb_memory_free(line);
	rb_memory_free(row);
	return status;
}

enum rb_status rb_folder_check(const char *folder, const struct rb_plan *plan, bool rows,
                               struct rb_error *err)
{
	char path[RB_FOLDER_PATH_SIZE];
	enum rb_status status = rb_folder_name(folder, RB_FOLDER_PLAN, path, err);

	if (status)
		return status;
	FILE *const file = fopen(path, "re");
	if (!file)
		return RB_FAIL(err, RB_ERR_INPUT, "cannot open '%s': %s", path, strerror(errno));
	status = compare(file, path, plan, rows, err);
	fclose(file);
	return status;
}

/* ---- writing ---- */

/*
 * Fails if the folder holds anything but what a sweep that was stopped at its very beginning may
 * have left. No folder at all is right.
 */
static enum rb_status check_empty(const char *folder, struct rb_error *err)
{
	enum rb_status status = RB_OK;
	DIR *const dir = opendir(folder);

	if (!dir && errno == ENOENT)
		return RB_OK;
	if (!dir)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot use '%s': %s", folder, strerror(errno));
	for (struct dirent *entry; !status && (entry = readdir(dir));) {
		const char *const name = entry->d_name;
		if (strcmp(name, ".") && strcmp(name, "..") && strcmp(name, "scene") &&
		    strcmp(name, "lua") && strncmp(name, RB_FOLDER_PLAN, sizeof RB_FOLDER_PLAN - 1))
			status = RB_FAIL(
				err, RB_ERR_CREATE,
				"cannot sweep into '%s': it holds '%.60s' and no plan of a sweep",
				folder, name);
	}
	closedir(dir);
	return status;
}

/*
 * Writes the copy of a file of the scene; RB_OK without one where it leads out of the scene's
 * folder.
 */
static enum rb_status write_copy(const char *folder, const struct rb_source_file *from,
                                 bool is_scene, struct rb_error *err)
{
	char name[RB_FOLDER_PATH_SIZE], path[RB_FOLDER_PATH_SIZE];
	struct rb_outfile out;

	if (!copy_name(from->name, is_scene, name))
		return RB_OK;
	enum rb_status status = rb_folder_name(folder, name, path, err);
	if (!status)
		status = rb_outfile_folders(path, RB_PLACE_BELOW(strlen(folder)), err);
	if (!status)
		status = rb_outfile_open(&out, path,
		                         RB_PLACE_REPLACE | RB_PLACE_BELOW(strlen(folder)), err);
	if (status)
		return status;
	(void)!fwrite(from->text, 1, from->size_bytes, out.file); /* told by publish */
	return rb_outfile_publish(&out, err);
}

/* Writes all of plan.csv; RB_ERR_CREATE where another sweep has published one meanwhile. */
static enum rb_status write_plan(const char *path, const struct rb_plan *plan, struct rb_error *err)
{
	struct rb_outfile out;
	char *const row = rb_memory_take(plan->row_size, 1);

	if (!row)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot write '%s': out of memory", path);
	const enum rb_status status = rb_outfile_open(&out, path, false, err);
	if (status) {
		rb_memory_free(row);
		return status;
	}
	for (int i = 0; i < plan->line_count; i++)
		fprintf(out.file, "%s\n", plan->lines[i]);
	rb_plan_titles(plan, row);
	fprintf(out.file, "%s\n", row);
	for (uint64_t i = 0; i < plan->count && !ferror(out.file); i++) {
		rb_plan_row(plan, i, row);
		fprintf(out.file, "%s\n", row);
	}
	rb_memory_free(row);
	return rb_outfile_publish(&out, err);
}

enum rb_status rb_folder_write(const char *folder, const struct rb_plan *plan,
                               const struct rb_source_file *files, bool *there,
                               struct rb_error *err)
{
	char path[RB_FOLDER_PATH_SIZE];
	enum rb_status status = check_empty(folder, err);

	*there = false;
	if (!status)
		status = rb_folder_name(folder, RB_FOLDER_PLAN, path, err);
	if (!status)
		status = rb_outfile_folders(path, 0, err);
	for (int i = 0; i < plan->file_count && !status; i++)
		status = write_copy(folder, &files[i], i == 0, err);
	if (!status)
		status = write_plan(path, plan, err);
	/* whatever failed: if there is a plan now, somebody else has written it at the same time */
	if (status && rb_folder_has_plan(folder)) {
		*there = true;
		return RB_OK;
	}
	return status;
}
