/* SPDX-License-Identifier: MIT */
#include "base/address_space.h"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>

void rb_address_space_share_arenas(void)
{
#ifdef M_ARENA_MAX
	/*
	 * glibc reserves 64 MiB for each thread that allocates; one for which it cannot takes a
	 * page for each block, however small.
	 */
	const rlim_t few = (rlim_t)1 << 30;
	struct rlimit limit;

	if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur < few)
		mallopt(M_ARENA_MAX, 1);
#endif
}

bool rb_address_space_has(size_t bytes)
{
	void *const room = mmap(NULL, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
	                        -1, 0);

	return room != MAP_FAILED && munmap(room, bytes) == 0;
}
