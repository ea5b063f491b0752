# SPDX-License-Identifier: MIT
#
#   make                 build/release/rbsim and its HDF5 module
#   make deps            install what is missing (says what and why)
#   make demo            run a scene        make test        all tests, in a minute or two
#   make lint            all style gates    make test-long   with those that take longer
#   make deps-slurm test-slurm              sweeps through a Slurm that the test starts
#   make bench           the numbers        make fuzz        FUZZ_SECONDS=600 per target
#   make install         DESTDIR, prefix, bindir, libdir, moduledir, includedir, mandir, zshdir, datadir
#   make deb             source and binary packages for Debian, of the last commit
#   make format          lay the sources out as .clang-format says
#
# MODE=release|debug|asan|tsan|cov builds into build/$(MODE)/ (or BUILD=folder); WERROR=1 makes warnings
# errors; V=1 shows whole commands; LAYERS="base math" leaves out the other layers. WITH_FILM=0 leaves out pictures and video (OSMesa
# or EGL, libpng, FreeType), WITH_CONSOLE=0 the console (ncurses); GL=osmesa or GL=egl says how contexts of OpenGL are made where
# both are there. CPPFLAGS, CFLAGS, LDFLAGS and LDLIBS are the
# user's: they are appended to what the project needs. Nothing here asks pkg-config before a recipe
# needs the answer, so that `make deps test` works where nothing is installed.

MODE ?= release
BUILD ?= build/$(MODE)
LAYERS ?=
WITH_FILM ?= 1
WITH_CONSOLE ?= 1
GL ?=
FUZZ_SECONDS ?= 600
V ?= 0
prefix ?= /usr/local
bindir ?= $(prefix)/bin
libdir ?= $(prefix)/lib
moduledir ?= $(prefix)/lib/rbsim
includedir ?= $(prefix)/include
datadir ?= $(prefix)/share
mandir ?= $(datadir)/man
zshdir ?= $(datadir)/zsh/site-functions

flags_release = -O2 -g
flags_debug = -O0 -g3 -DRB_CHECKED_BUILD
# -g1: lines, which reports need, and no variables, which took a quarter of the time to compile
flags_asan = -DRB_CHECKED_BUILD -O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=undefined
# Its tests look for races; what each step promises is asserted in asan's.
flags_tsan = -O1 -g1 -fno-omit-frame-pointer -fsanitize=thread
flags_cov = -O0 -g --coverage
flags_fuzz = -DRB_CHECKED_BUILD -O1 -g -fno-omit-frame-pointer -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
ifeq ($(filter-out undefined,$(origin flags_$(MODE))),)
$(error MODE='$(MODE)' is not one of release, debug, asan, tsan, cov)
endif

warnings = -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion -Wstrict-prototypes \
	-Wmissing-prototypes -Wvla -Wundef -Wformat=2 -Wwrite-strings $(if $(filter 1,$(WERROR)),-Werror)
mode_flags = $(flags_$(MODE))
compile = $(CC) -std=c17 -D_GNU_SOURCE -Iinclude -Isrc -ffp-contract=off -pthread $(pic) $(mode_flags) $(hard_compile) $(hard_part) $(warnings)
# One object serves program, modules and librbsim.so: the linker makes of PIC what -fPIE would have been.
pic = -fPIC -fno-semantic-interposition
compile_user = $(CPPFLAGS) $(CFLAGS)
link = $(CC) $(mode_flags) -pthread -Wl,--as-needed $(hard_link) $(CFLAGS) $(LDFLAGS)

# What makes mistakes of ours harder to use against whoever runs a release, as far as compiler and linker take it: all of it is
# tried together, each alone only where that fails.
tried = '\#include <stdio.h>' 'int main(void){return puts("");}'
takes = printf '%s\n' $(tried) | $(CC) -O2 -Werror $1 -x c - -o /dev/null
chosen = $(shell if $(call takes,$1); then echo '$1'; else for f in $1; do $(call takes,$$f) && echo "$$f"; done; fi 2>/dev/null)
ifeq ($(MODE),release)
hard_compile = $(eval hard_compile := -U_FORTIFY_SOURCE $(or $(call chosen,-D_FORTIFY_SOURCE=3),$(call \
	chosen,-D_FORTIFY_SOURCE=2)) $(call chosen,-fstack-protector-strong -fstack-clash-protection -fcf-protection))$(hard_compile)
hard_link = $(eval hard_link := $(call chosen,-Wl$(comma)-z$(comma)relro -Wl$(comma)-z$(comma)now))$(hard_link)
# Layers of numbers hand vectors about by value: a guard in every function that does costs 3 % of all instructions, one in those that
# have bytes on the stack nothing.
$(foreach l,math geom shape force world step constraint located stepped classic method,$(BUILD)/src/$(l)/%.o): hard_part = $(if $(filter \
	-fstack-protector-strong,$(hard_compile)),-fstack-protector)
hard_program = $(eval hard_program := $(call chosen,-pie))$(hard_program)
endif

comma := ,
say = @$(if $(filter 0,$(V)),printf '%-5s %s\n' '$1' '$@',printf '%s\n' $(call shell_word,$2)) && $2

# Flags of the first package of $2 that pkg-config knows, asked once and only when a recipe needs them.
found = $(if $2,$(patsubst -I%,-isystem %,$(wordlist 2,99,$2)),$(error no library '$1' for pkg-config: try 'make deps'))
package = $(call found,$(firstword $2),$(shell for p in $2; do \
	pkg-config --exists $$p && echo found && pkg-config $1 $$p && break; done 2>/dev/null))
lua = lua5.4 lua-5.4 lua5.5 lua-5.5
LUA_CFLAGS = $(eval LUA_CFLAGS := $(call package,--cflags,$(lua)))$(LUA_CFLAGS)
LUA_LIBS = $(eval LUA_LIBS := $(call package,--libs,$(lua)))$(LUA_LIBS)
HDF5_CFLAGS = $(eval HDF5_CFLAGS := $(call package,--cflags,hdf5-serial hdf5))$(HDF5_CFLAGS)
# Mesa has no OSMesa from 25.1 on.
gl = $(eval gl := $(or $(GL),$(shell pkg-config --exists osmesa 2>/dev/null && echo osmesa || echo egl)))$(gl)
packages_osmesa = $(call package,$1,osmesa)
packages_egl = $(call package,$1,egl) $(call package,$1,opengl)
film_packages = $(call packages_$(gl),$1) $(call package,$1,libpng) $(call package,$1,freetype2)
FILM_CFLAGS = $(eval FILM_CFLAGS := $(call film_packages,--cflags) $(if $(filter egl,$(gl)),-DRB_GL_EGL))$(FILM_CFLAGS)
FILM_LIBS = $(eval FILM_LIBS := $(call film_packages,--libs))$(FILM_LIBS)
CONSOLE_CFLAGS = $(eval CONSOLE_CFLAGS := $(call package,--cflags,ncursesw))$(CONSOLE_CFLAGS)
CONSOLE_LIBS = $(eval CONSOLE_LIBS := $(call package,--libs,ncursesw))$(CONSOLE_LIBS)
HDF5_LIBS = $(eval HDF5_LIBS := $(call package,--libs,hdf5-serial hdf5))$(HDF5_LIBS)
HASH_CFLAGS = $(eval HASH_CFLAGS := $(call package,--cflags,libxxhash) $(call package,--cflags,libmd))$(HASH_CFLAGS)
HASH_LIBS = $(eval HASH_LIBS := $(call package,--libs,libmd))$(HASH_LIBS)
HULL_CFLAGS = $(eval HULL_CFLAGS := $(call package,--cflags,qhullstatic_r qhull_r))$(HULL_CFLAGS)
HULL_LIBS = $(eval HULL_LIBS := $(call package,--libs,qhullstatic_r qhull_r))$(HULL_LIBS)
# Debian's static one is not position independent.
HULL_SHARED_LIBS = $(eval HULL_SHARED_LIBS := $(call package,--libs,qhull_r qhullstatic_r))$(HULL_SHARED_LIBS)
CMOCKA_CFLAGS = $(eval CMOCKA_CFLAGS := $(call package,--cflags,cmocka))$(CMOCKA_CFLAGS)
CMOCKA_LIBS = $(eval CMOCKA_LIBS := $(call package,--libs,cmocka))$(CMOCKA_LIBS)
libs = $(LUA_LIBS) $(HULL_LIBS) $(HASH_LIBS) -lm -ldl $(LDLIBS)
public_libs = $(HDF5_LIBS) $(LUA_LIBS) $(HULL_SHARED_LIBS) $(HASH_LIBS) -lm -ldl $(LDLIBS)

# src/ORDER is the only list of modules; what needs HDF5, what makes pictures and what needs curses become modules that are loaded at run time.
listed := $(shell sh tools/modules src/ORDER)
console_modules := $(addprefix control/,screen panels desk deskmodule)
left_out := $(if $(filter 0,$(WITH_FILM)),film/%) $(if $(filter 0,$(WITH_CONSOLE)),$(console_modules))
modules := $(filter-out $(left_out),$(if $(LAYERS),$(filter $(LAYERS:%=%/%),$(listed)),$(listed)))
absent := $(strip $(foreach m,$(modules),$(if $(wildcard src/$(m).c src/$(m).h),,$(m))))
$(if $(absent),$(warning src/ORDER lists modules without files: $(absent)))
sources := $(foreach m,$(modules),$(wildcard src/$(m).c))
h5_sources := $(filter src/sink/h5% src/sink/recorder.c src/sink/reader.c,$(sources))
main_source := $(filter src/app/main.c,$(sources))
objects = $(patsubst %.c,$(BUILD)/%.o,$1)
h5_objects := $(call objects,$(h5_sources))
film_sources := $(filter src/film/%,$(sources))
film_objects := $(call objects,$(film_sources))
console_sources := $(filter $(console_modules:%=src/%.c),$(sources))
console_objects := $(call objects,$(console_sources))
lib_objects := $(call objects,$(filter-out $(h5_sources) $(film_sources) $(console_sources) $(main_source),$(sources)))
embed_objects := $(filter $(BUILD)/src/embed/%,$(lib_objects))
# of librbsim: what a scene needs from its file to its recording, HDF5's part linked in
public_objects := $(filter-out $(foreach l,film control sweep app,$(BUILD)/src/$(l)/%),$(lib_objects)) $(h5_objects)
untested := $(if $(filter 0,$(WITH_FILM)),tests/test_film% $(addprefix tests/cli/,film-%.sh scenes-film.sh control-film.sh)) \
	$(if $(filter 0,$(WITH_CONSOLE)),tests/test_panels.c tests/cli/console-%.sh)
# A data race needs threads: of the tests in C those that start some (arcs have one thread, and what is saved comes back
# outside of steps; the rasteriser's are not ours, an encoder is a process), and no scripts that are about numbers, texts and
# refusals alone: scenes-run.sh runs every scene, film-run.sh, film-render.sh, film-split.sh and scenes-film.sh make films.
ifeq ($(MODE),tsan)
threaded := $(sort $(shell grep -E 'team|thread|pump|_ring|server|overtime|app/checkpoint' tests/test_*.c | \
	sed '/[.]threads = 1[,}]/d; s/:.*//'))
untested += $(filter-out $(threaded),$(wildcard tests/test_*.c)) \
	$(wildcard tests/test_located_*.c) $(addprefix tests/test_,convex.c film_encoder.c film_painter.c save.c \
	stepped_second_half.c) \
	$(addprefix tests/cli/,damage.sh ledger.sh located-%.sh oracle%.sh random%.sh mutate.sh physics-%.sh scene-joints.sh scene-values.sh \
	check-%.sh converge.sh diff-recordings.sh docs.sh export.sh film-arc.sh film-callback.sh film-framing.sh film-golden.sh film-lights.sh \
	film-plots.sh film-texts.sh film-units.sh film-vectors.sh \
	info-recording.sh joint-%.sh manual-examples.sh methods.sh options-%.sh \
	plan-golden.sh plot.sh python.sh recording-forces.sh recording-joints.sh recording-readers.sh results.sh run-links.sh \
	run-refusals.sh run-small.sh run-steps.sh run-visible.sh scene-gravitation.sh \
	scene-forces.sh scene-helpers.sh scene-loads.sh scene-manual.sh scene-many.sh scene-mesh.sh scene-motion.sh scene-particles.sh \
	scene-potential.sh scene-sandbox.sh scene-solids.sh scenes-expect.sh scenes-open.sh scenes-tolerance.sh sweep-refusals.sh terrain.sh \
	tutorial.sh verify.sh versions.sh workflows.sh)
endif
# Numbers alone, by code that other tests of these builds run too: for release.
ifeq ($(MODE),asan)
untested += tests/test_located_same.c $(addprefix tests/cli/,physics-located.sh python.sh scenes-expect.sh scenes-tolerance.sh \
	tutorial.sh verify.sh)
endif
test_sources := $(filter-out $(untested),$(wildcard tests/test_*.c))
tests := $(test_sources:%.c=$(BUILD)/%)
cli_tests := $(filter-out $(untested),$(wildcard tests/cli/*.sh))
# Of the long ones those that would be last by name: begun first, none is alone at the end.
cli_first := $(filter $(addprefix tests/cli/,scenes-run.sh terrain.sh tutorial.sh verify.sh),$(cli_tests))
cli_tests := $(cli_first) $(filter-out $(cli_first),$(cli_tests))
fuzz_sources := $(wildcard tests/fuzz/fuzz_*.c)

program := $(BUILD)/rbsim
version := $(shell sed -n 's/^.define RBSIM_VERSION "\(.*\)"/\1/p' include/rbsim.h)
soname := librbsim.so.$(firstword $(subst ., ,$(version)))
# with all names, for tests
library := $(BUILD)/librbsim-internal.a
public := $(if $(LAYERS),,$(if $(filter release debug,$(MODE)),$(BUILD)/librbsim.so.$(version) $(BUILD)/librbsim.a))
h5_module := $(BUILD)/rbsim-hdf5.so
film_module := $(if $(film_sources),$(BUILD)/rbsim-film.so)
console_module := $(if $(console_sources),$(BUILD)/rbsim-console.so)
# A name that the program has too, unnoticed, would otherwise be the program's in the module.
own_names := -Wl,-Bsymbolic
loaded := $(h5_module) $(film_module) $(console_module)
seconds = $(if $(filter release debug,$(MODE)),400,900)
run_tests = RBSIM_MODE=$(MODE) TEST_SECONDS=$(seconds) \
	TEST_WRAP="$(if $(filter tsan,$(MODE)),$$(setarch -R true 2>/dev/null && echo setarch -R))" tools/run-tests $(program)

.DELETE_ON_ERROR:
.SUFFIXES:
.SECONDARY:
.PHONY: all build-tests warnings deps deps-slurm demo test test-long test-slurm bench fuzz fuzz-run lint format install uninstall deb clean FORCE

all: $(program) $(loaded) $(library) $(public) compile_commands.json

# The program takes all objects, not what it happens to use of the library: the module uses the others.
$(program): $(filter-out $(embed_objects),$(lib_objects)) $(call objects,$(main_source)) $(BUILD)/modules
	$(call say,LD,$(link) $(hard_program) -rdynamic -o $@ $(filter %.o,$^) $(libs))
$(h5_module): $(h5_objects) $(BUILD)/modules
	$(call say,LD,$(link) -shared $(own_names) -o $@ $(filter %.o,$^) $(HDF5_LIBS) $(LDLIBS))
$(film_module): $(film_objects) $(BUILD)/modules
	$(call say,LD,$(link) -shared $(own_names) -o $@ $(filter %.o,$^) $(FILM_LIBS) -lm $(LDLIBS))
$(console_module): $(console_objects) $(BUILD)/modules
	$(call say,LD,$(link) -shared $(own_names) -o $@ $(filter %.o,$^) $(CONSOLE_LIBS) $(LDLIBS))
$(library): $(lib_objects) $(BUILD)/modules
	@rm -f $@
	$(call say,AR,$(AR) rcs $@ $(filter %.o,$^))
# Names of ours are nobody else's: rb_ is Ruby's, too.
$(BUILD)/librbsim.so.$(version): $(public_objects) src/embed/librbsim.map $(BUILD)/modules
	$(call say,LD,$(link) -shared -Wl$(comma)-z$(comma)defs -Wl$(comma)-soname$(comma)$(soname) \
	-Wl$(comma)--version-script=src/embed/librbsim.map -o $@ $(filter %.o,$^) $(public_libs))
$(BUILD)/librbsim.a: $(public_objects) $(BUILD)/modules
	@rm -f $@
	$(call say,AR,$(CC) -r -nostdlib -o $(BUILD)/librbsim.o $(filter %.o,$^) && \
	objcopy -w --keep-global-symbol='rbsim_*' $(BUILD)/librbsim.o && $(AR) rcs $@ $(BUILD)/librbsim.o)
$(tests): $(BUILD)/tests/%: $(BUILD)/tests/%.o $(library)
	$(call say,LD,$(link) $(hard_program) $(wrap) -o $@ $(filter %.o,$^) $(library) $(h5_libs) $(film_libs) $(CMOCKA_LIBS) $(libs))
$(filter $(BUILD)/tests/test_h5%,$(tests)): $(h5_objects)
$(filter $(BUILD)/tests/test_h5%,$(tests)): h5_libs = $(HDF5_LIBS)
$(filter $(BUILD)/tests/test_film%,$(tests)): $(film_objects)
$(filter $(BUILD)/tests/test_film%,$(tests)): film_libs = $(FILM_LIBS)
$(BUILD)/tests/test_panels: $(filter %/panels.o,$(console_objects))
# it puts its own in their place
$(BUILD)/tests/test_converge: wrap = -Wl,--wrap=rb_rung_run,--wrap=rb_clock_now_ns

extra =
$(BUILD)/src/script/%.o $(BUILD)/src/app/%.o: extra = $(LUA_CFLAGS)
$(BUILD)/src/geom/hull.o: extra = $(HULL_CFLAGS)
$(BUILD)/src/base/hash.o: extra = $(HASH_CFLAGS)
$(h5_objects): extra = $(HDF5_CFLAGS)
$(film_objects): extra = $(FILM_CFLAGS)
$(console_objects): extra = $(CONSOLE_CFLAGS)
$(BUILD)/src/sink/module.o: extra = $(if $(filter 0,$(WITH_FILM)),-DRB_WITHOUT_FILM) $(if $(filter 0,$(WITH_CONSOLE)),-DRB_WITHOUT_CONSOLE)
$(filter %_osmesa.o %_egl.o,$(film_objects)) $(BUILD)/src/sink/module.o: $(BUILD)/modules
# references are computed in long double, to which clang warns of every promotion
test_flags = -Itests -Wno-double-promotion $(CMOCKA_CFLAGS) $(LUA_CFLAGS)
$(BUILD)/tests/%.o: extra = $(test_flags)
$(BUILD)/tests/test_h5%.o: extra = $(test_flags) $(HDF5_CFLAGS)
$(BUILD)/tests/test_film%.o: extra = $(test_flags) $(FILM_CFLAGS)
$(BUILD)/tests/fuzz/%.o: extra = $(LUA_CFLAGS)
$(BUILD)/%.o: %.c $(BUILD)/flags
	@mkdir -p $(@D)
	$(call say,CC,$(compile) $(extra) $(compile_user) $(or $(syntax_only),-MMD -MP -c -o $@) $<)

shell_word = '$(subst ','\'',$1)'
# Stamps, rewritten only when their text changes. `deps` goes first when it is asked for too, even under -j.
# Whether warnings are errors changes no object.
$(BUILD)/flags: text = $(filter-out -Werror,$(compile)) $(compile_user) $(link) $(LDLIBS)
$(BUILD)/modules: text = $(modules) $(GL) $(link) $(LDLIBS)
$(BUILD)/flags $(BUILD)/modules: FORCE | $(BUILD)/ $(filter deps,$(MAKECMDGOALS))
	@printf '%s\n' $(call shell_word,$(text)) >$@.new; cmp -s $@.new $@ && rm $@.new || mv $@.new $@
$(BUILD)/:
	@mkdir -p $@

json = "$(subst ",\",$(subst \,\\,$1))"
entry = {"directory": $(call json,$(CURDIR))$(comma) "file": "$1"$(comma) "command": $(call \
	json,$(compile) $2 $(compile_user) -c $1)}$(if $(filter-out $(lastword $(sources)),$1),$(comma))
flags_of = $(if $(filter $1,$(h5_sources)),$(HDF5_CFLAGS),$(if $(filter $1,$(film_sources)),\
	$(FILM_CFLAGS),$(if $(filter $1,$(console_sources)),$(CONSOLE_CFLAGS),$(if $(filter src/script/% \
	src/app/%,$1),$(LUA_CFLAGS),$(if $(filter src/geom/hull.c,$1),$(HULL_CFLAGS))$(if $(filter src/base/hash.c,$1),$(HASH_CFLAGS))))))
# by make itself: all of it is too long for a word of a shell's command
compile_commands.json: $(BUILD)/flags $(BUILD)/modules Makefile
	$(file >$@,[)$(foreach s,$(sources),$(file >>$@,$(call entry,$(s),$(call flags_of,$(s)))))$(file >>$@,])@:

build_deps = build $(if $(filter 0,$(WITH_FILM)),,film) $(if $(filter 0,$(WITH_CONSOLE)),,console)
# What is needed follows from what else is asked for; alone, all but the fuzzer.
deps:
	@tools/deps $(build_deps) $(if $(filter-out deps,$(MAKECMDGOALS)),$(if $(filter test test-long bench,$(MAKECMDGOALS)),test) \
	$(filter lint fuzz,$(MAKECMDGOALS)),test lint)
deps-slurm:
	@tools/deps $(build_deps) test slurm
demo: all
	@mkdir -p build/demo
	cd build/demo && $(abspath $(program)) $(CURDIR)/scenes/bounce.lua --force
	@echo "the recording is build/demo/bounce.h5 (look inside: $(program) info build/demo/bounce.h5)"
	@echo "the film is build/demo/bounce.mp4 (another one: $(program) render build/demo/bounce.h5 -o slow.gif --speed 0.25)"
build-tests: $(tests)
# What a compiler says of all sources, without code, which takes most of the time.
warnings: syntax_only = -fsyntax-only
warnings: $(call objects,$(sources) $(test_sources))
test: $(program) $(loaded) $(public) $(tests)
	@$(run_tests) $(tests) $(cli_tests)
test-long: seconds = 3600
test-long: $(program) $(loaded) $(public) $(tests)
	@$(run_tests) $(tests) $(cli_tests) $(wildcard tests/long/*.sh)
test-slurm: seconds = 3600
test-slurm: $(program) $(loaded)
	@$(run_tests) $(wildcard tests/long/sweep-slurm*.sh)
bench: $(program) $(loaded)
	@for b in $(wildcard tests/bench/*.sh); do RBSIM=$(abspath $(program)) "$$b" || exit 1; done
fuzz: | $(filter deps,$(MAKECMDGOALS))
	@$(MAKE) --no-print-directory MODE=fuzz BUILD=build/fuzz CC=clang fuzz-run
# Under -j several at a time.
fuzz_runs := $(fuzz_sources:tests/fuzz/fuzz_%.c=fuzz-run-%)
.PHONY: $(fuzz_runs)
fuzz-run: $(fuzz_runs)
$(fuzz_runs): fuzz-run-%: $(BUILD)/fuzz_%
	@c=$(BUILD)/corpus_$*; s=tests/fuzz/corpus_$*; mkdir -p $$c; \
	[ -d $$s ] || s=; echo "fuzz_$*: $(FUZZ_SECONDS) s"; $< -max_total_time=$(FUZZ_SECONDS) -timeout=20 \
	-print_final_stats=1 -artifact_prefix=$(BUILD)/$*- $$c $$s >$<.log 2>&1 || { tail -n 40 $<.log; exit 1; }; \
	grep -E 'number_of_executed_units|slowest_unit' $<.log | sed 's/^/fuzz_$*: /'
$(BUILD)/fuzz_%: $(BUILD)/tests/fuzz/fuzz_%.o $(library)
	$(call say,LD,$(link) -fsanitize=fuzzer -o $@ $(filter %.o,$^) $(library) $(film_libs) $(libs))
$(BUILD)/fuzz_png: $(call objects,src/film/png.c src/film/pixmap.c)
$(BUILD)/fuzz_png: film_libs = $(FILM_LIBS)
lint: $(program) $(loaded) $(library)
	@tools/lint $(BUILD)
format:
	tools/check-format --fix

install_all = install -d $(DESTDIR)$2 && install -m $1 $3 $(DESTDIR)$2
scene_folders = $(if $(wildcard scenes),$(shell cd scenes && find . -type d))
install: all
	$(call install_all,755,$(bindir),$(program))
	$(call install_all,644,$(moduledir),$(loaded))
	$(call install_all,644,$(libdir),$(public))
	ln -sf librbsim.so.$(version) $(DESTDIR)$(libdir)/$(soname)
	ln -sf $(soname) $(DESTDIR)$(libdir)/librbsim.so
	$(call install_all,644,$(includedir),include/rbsim.h)
	install -d $(DESTDIR)$(libdir)/pkgconfig
	sed -e 's|@prefix@|$(prefix)|' -e 's|@libdir@|$(libdir)|' -e 's|@includedir@|$(includedir)|' \
	-e 's|@version@|$(version)|' -e 's|@libs@|$(strip $(public_libs) -pthread)|' \
	tools/rbsim.pc.in >$(DESTDIR)$(libdir)/pkgconfig/rbsim.pc
	$(if $(wildcard lua/rbsim/*.lua),$(call install_all,644,$(datadir)/rbsim/lua/rbsim,$(wildcard lua/rbsim/*.lua)))
	$(foreach d,$(scene_folders),$(if $(wildcard scenes/$(d)/*.lua),$(call \
	install_all,644,$(datadir)/rbsim/scenes/$(d:./%=%),$(wildcard scenes/$(d)/*.lua)) &&)) :
	$(foreach s,1 3 5 7,$(if $(wildcard man/*.$(s)),$(call install_all,644,$(mandir)/man$(s),$(wildcard man/*.$(s))) &&)) :
	$(if $(wildcard tools/completion/rbsim.bash),install -D -m 644 tools/completion/rbsim.bash \
	$(DESTDIR)$(datadir)/bash-completion/completions/rbsim)
	$(if $(wildcard tools/completion/_rbsim),install -D -m 644 tools/completion/_rbsim \
	$(DESTDIR)$(zshdir)/_rbsim)
uninstall:
	rm -f $(DESTDIR)$(bindir)/rbsim $(DESTDIR)$(datadir)/bash-completion/completions/rbsim \
	$(DESTDIR)$(zshdir)/_rbsim $(foreach s,1 3 5 7,$(addprefix $(DESTDIR)$(mandir)/man$(s)/,$(notdir $(wildcard man/*.$(s))))) \
	$(addprefix $(DESTDIR)$(libdir)/,librbsim.a librbsim.so librbsim.so.* pkgconfig/rbsim.pc) $(DESTDIR)$(includedir)/rbsim.h
	rm -rf $(DESTDIR)$(moduledir) $(DESTDIR)$(datadir)/rbsim
deb:
	tools/deb build/deb
clean:
	rm -rf build compile_commands.json

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)
