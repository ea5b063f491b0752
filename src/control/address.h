/* SPDX-License-Identifier: MIT */
/*
 * Names of sockets in the file system: taking one for a run, without ever taking it from another,
 * and giving it back.
 *
 * Values; nothing is owned but the descriptor that rb_address_listen gives to the caller.
 */
#ifndef RB_CONTROL_ADDRESS_H
#define RB_CONTROL_ADDRESS_H

#include <sys/types.h>
#include <sys/un.h>

#include <rbsim/error.h>

/* Which file a socket's name stood for, to know it again. */
struct rb_address_file {
	dev_t device;
	ino_t inode;
};

/* `failure` is the status when the path does not fit into an address. */
RB_CHECKED enum rb_status rb_address_of(struct sockaddr_un *address, const char *path,
                                        enum rb_status failure, struct rb_error *err);

/*
 * Binds and listens, mode 0600 from the first moment. A socket on which nobody listens any more is
 * replaced. RB_ERR_CREATE where another process listens, or the path is no socket.
 */
RB_CHECKED enum rb_status rb_address_listen(int *fd, struct rb_address_file *file, const char *path,
                                            struct rb_error *err);
/* Takes the name away if it still stands for that file. */
void rb_address_remove(const char *path, const struct rb_address_file *file);

#endif
