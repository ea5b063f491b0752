/* SPDX-License-Identifier: MIT */
/* src/control/address.c: names of sockets: taken, never stolen, given back */
#include "support.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include "control/address.h"

struct place {
	char folder[256], path[300];
	struct rb_error err;
};

static void open_place(struct place *place)
{
	*place = (struct place){0};
	support_folder(place->folder);
	snprintf(place->path, sizeof place->path, "%s/s", place->folder);
}

static void close_place(struct place *place)
{
	unlink(place->path);
	assert_int_equal(rmdir(place->folder), 0);
}

static int listen_at(struct place *place, struct rb_address_file *file)
{
	int fd = -1;

	if (rb_address_listen(&fd, file, place->path, &place->err) != RB_OK)
		fail_msg("%s", place->err.text);
	assert_true(fd >= 0);
	return fd;
}

static void assert_refused(struct place *place, const char *part)
{
	struct rb_address_file file;
	int fd = 7;

	assert_int_equal(rb_address_listen(&fd, &file, place->path, &place->err), RB_ERR_CREATE);
	assert_int_equal(fd, -1);
	if (!strstr(place->err.text, part))
		fail_msg("'%s' has no '%s'", place->err.text, part);
}

/* Whether somebody answers there. */
static bool answers(const struct place *place)
{
	struct sockaddr_un address;
	struct rb_error err;

	assert_ok(rb_address_of(&address, place->path, RB_ERR_INPUT, &err));
	const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	const bool answered = connect(fd, (const struct sockaddr *)&address, sizeof address) == 0;
	close(fd);
	return answered;
}

/* sun_path takes 108 bytes with a zero (unix(7)). */
static void a_name_fits_into_an_address_or_is_refused(void **state)
{
	char path[200];
	struct sockaddr_un address;
	struct rb_error err;

	(void)state;
	for (size_t size = 1; size < 108; size++) {
		memset(path, 'a', size);
		path[size] = '\0';
		assert_ok(rb_address_of(&address, path, RB_ERR_INPUT, &err));
		assert_int_equal(address.sun_family, AF_UNIX);
		assert_string_equal(address.sun_path, path);
	}
	memset(path, 'a', 108);
	path[108] = '\0';
	assert_int_equal(rb_address_of(&address, path, RB_ERR_INPUT, &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "aaa...' has a name of 108 bytes, wanted 1 to 107"));
	assert_int_equal(rb_address_of(&address, "", RB_ERR_USAGE, &err), RB_ERR_USAGE);
	assert_string_equal(err.text, "socket '' has a name of 0 bytes, wanted 1 to 107");
}

static void a_socket_lets_nobody_else_in(void **state)
{
	struct rb_address_file file;
	struct place place;
	struct stat about;

	(void)state;
	open_place(&place);
	const mode_t before = umask(0);
	const int fd = listen_at(&place, &file);
	assert_int_equal(umask(before), 0); /* the mask is as it was */
	assert_int_equal(lstat(place.path, &about), 0);
	assert_true(S_ISSOCK(about.st_mode));
	assert_int_equal(about.st_mode & 0777, 0600);
	assert_true(about.st_ino == file.inode && about.st_dev == file.device);
	assert_true(answers(&place));
	/* programs that are started do not get it, and nobody waits in it */
	assert_true(fcntl(fd, F_GETFD) & FD_CLOEXEC);
	assert_true(fcntl(fd, F_GETFL) & O_NONBLOCK);
	rb_address_remove(place.path, &file);
	assert_int_equal(access(place.path, F_OK), -1);
	close(fd);
	close_place(&place);
}

static void a_name_that_another_listens_on_is_never_taken(void **state)
{
	struct rb_address_file file;
	struct place place;

	(void)state;
	open_place(&place);
	const int fd = listen_at(&place, &file);
	assert_refused(&place, "a process that runs listens there");
	assert_true(answers(&place));
	close(fd);
	assert_false(answers(&place));
	/* now nobody does: it is left over */
	struct rb_address_file next;
	const int again = listen_at(&place, &next);
	assert_true(answers(&place));
	rb_address_remove(place.path, &next);
	close(again);
	close_place(&place);
}

static void files_that_are_no_sockets_stay(void **state)
{
	struct place place;
	char target[300];
	struct stat about;

	(void)state;
	open_place(&place);
	const int file = open(place.path, O_CREAT | O_WRONLY, 0600);
	assert_int_equal(write(file, "mine", 4), 4);
	close(file);
	assert_refused(&place, "a file that is not a socket has that name");
	assert_int_equal(stat(place.path, &about), 0);
	assert_int_equal(about.st_size, 4);
	unlink(place.path);
	assert_int_equal(mkdir(place.path, 0700), 0);
	assert_refused(&place, "a file that is not a socket has that name");
	assert_int_equal(rmdir(place.path), 0);
	/* a link to one that is left over: what it leads to is not ours to take away */
	snprintf(target, sizeof target, "%s/t", place.folder);
	assert_int_equal(symlink(target, place.path), 0);
	assert_refused(&place, "a file that is not a socket has that name");
	unlink(place.path);
	close_place(&place);
	assert_refused(&place, "No such file or directory");
}

static void only_ones_own_name_is_taken_away(void **state)
{
	struct rb_address_file first, second;
	struct place place;
	char moved[300];

	(void)state;
	open_place(&place);
	snprintf(moved, sizeof moved, "%s/moved", place.folder);
	const int one = listen_at(&place, &first);
	assert_int_equal(rename(place.path, moved), 0); /* so that its number stays taken */
	const int two = listen_at(&place, &second);
	rb_address_remove(place.path, &first);
	assert_int_equal(access(place.path, F_OK), 0);
	rb_address_remove(place.path, &second);
	assert_int_equal(access(place.path, F_OK), -1);
	rb_address_remove(place.path, &second);
	close(one);
	close(two);
	unlink(moved);
	close_place(&place);
}

static void a_name_without_a_folder_is_in_the_current_one(void **state)
{
	struct rb_address_file file;
	struct place place;
	struct rb_error err;
	char before[4096];
	int fd;

	(void)state;
	open_place(&place);
	assert_non_null(getcwd(before, sizeof before));
	assert_int_equal(chdir(place.folder), 0);
	assert_ok(rb_address_listen(&fd, &file, "s", &err));
	assert_int_equal(chdir(before), 0);
	assert_true(answers(&place));
	rb_address_remove(place.path, &file);
	close(fd);
	close_place(&place);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_name_fits_into_an_address_or_is_refused),
		cmocka_unit_test(a_socket_lets_nobody_else_in),
		cmocka_unit_test(a_name_that_another_listens_on_is_never_taken),
		cmocka_unit_test(files_that_are_no_sockets_stay),
		cmocka_unit_test(only_ones_own_name_is_taken_away),
		cmocka_unit_test(a_name_without_a_folder_is_in_the_current_one),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
