#!/bin/sh
# SPDX-License-Identifier: MIT
# On a clean Debian of each release the packages build, lintian has nothing to say, they install, run and go again; and pip
# installs the Python package. Needs root, mmdebstrap and Debian's servers. RELEASES names other releases, CHROOTS a folder
# where their clean trees are kept from one time to the next, PACKAGES a folder for the packages.
. tests/cli/functions

case ${RBSIM_MODE:-release} in
release) ;;
*) echo "packages are built in release"; exit 77 ;;
esac
[ "$(id -u)" -eq 0 ] || { echo "only root can enter another Debian"; exit 77; }
for tool in mmdebstrap unshare git; do
	command -v $tool >/dev/null || { echo "no $tool: apt-get install mmdebstrap util-linux git"; exit 77; }
done
[ -d "$TOP/.git" ] || [ -f "$TOP/.git" ] || { echo "no repository: packages are made of its last commit"; exit 77; }
chroots=${CHROOTS:-$PWD/chroots}
mkdir -p "$chroots"

# inside ROOT COMMAND...: as root of that tree, with nothing of this machine's environment but its way to the net. Its mounts end
# with the command, so that the tree can be removed.
inside()
{
	inside_root=$1
	shift
	# shellcheck disable=SC2016 # it is for the other shell
	unshare --mount --propagation private sh -ec '
		mount -t proc proc "$1/proc"
		mount --rbind /dev "$1/dev"
		root=$1
		shift
		for name in http_proxy https_proxy no_proxy PIP_INDEX_URL; do
			eval "[ -z \"\${$name:-}\" ] || set -- \"$name=\$$name\" \"\$@\""
		done
		[ ! -f "$root/srv/certificates" ] || set -- PIP_CERT=/srv/certificates "$@"
		exec chroot "$root" env -i DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 HOME=/srv \
			PATH=/usr/sbin:/usr/bin:/sbin:/bin TMPDIR=/tmp "$@"' sh "$inside_root" "$@"
}

for release in ${RELEASES:-bookworm trixie}; do
	if [ ! -d "$chroots/$release/etc" ]; then
		mmdebstrap --quiet --variant=minbase "$release" "$chroots/$release" >log 2>&1 || {
			echo "no clean $release: $(tail -n 1 log)"
			exit 77
		}
	fi
	began=$(date +%s)
	cp -a "$chroots/$release" build
	# a tree that is thrown away needs no dpkg that waits for the disk
	echo force-unsafe-io >build/etc/dpkg/dpkg.cfg.d/thrown-away
	git clone --quiet --no-hardlinks "$TOP" build/src
	# the machine's certificates and way to packages of Python, where it has one of its own
	[ ! -f /etc/ssl/certs/ca-certificates.crt ] || cp /etc/ssl/certs/ca-certificates.crt build/srv/certificates
	{
		inside build apt-get -qq update
		inside build apt-get -qq install -y --no-install-recommends build-essential debhelper git lintian
		inside build sh -c 'cd /src && apt-get -qq build-dep -y --no-install-recommends .'
		inside build sh -c 'cd /src && git config --global --add safe.directory /src && tools/deb /packages'
	} >log 2>&1 || fail "$release: packages do not build: $(tail -n 20 log)"
	! grep -E '^[EW]: rbsim' log >err || fail "$release: lintian: $(cat err)"
	if [ -n "${PACKAGES:-}" ]; then
		mkdir -p "$PACKAGES/$release"
		cp build/packages/*.deb build/packages/*.dsc build/packages/*.tar.* "$PACKAGES/$release"
	fi

	built=$(date +%s)
	cp -a "$chroots/$release" clean
	cp build/etc/dpkg/dpkg.cfg.d/thrown-away clean/etc/dpkg/dpkg.cfg.d
	cp -a build/packages clean/srv/packages
	cp -a build/src/tools/python clean/srv/python
	[ ! -f build/srv/certificates ] || cp build/srv/certificates clean/srv/certificates
	cat >clean/srv/drop.lua <<'LUA'
world { duration = 0.5, gravity = {0, 0, -9.81} }
plane { normal = {0, 0, 1} }
sphere { name = "ball", radius = 0.1, position = {0, 0, 0.5} }
camera { png = "%d.png", fps = 4, size = {160, 120} }
LUA
	{
		inside clean apt-get -qq update
		# all of it, and what draws (recommended); what it needs comes from Debian alone
		inside clean sh -c 'apt-get -qq install -y --no-install-recommends /srv/packages/*.deb python3-venv libegl-mesa0 libgl1-mesa-dri'
		inside clean sh -c 'cd /srv && rbsim drop.lua --quiet && rbsim info drop.h5 && [ -s 0.png ]'
		inside clean sh -c 'cd /srv && python3 -c "import rbsim; print(rbsim.open(\"drop.h5\").position.shape)"'
		inside clean sh -c 'cd /srv && man -w rbsim-scene 2>/dev/null || ls /usr/share/man/man5/rbsim-scene.5.gz'
	} >log 2>&1 || fail "$release: what the packages install does not work: $(tail -n 20 log)"
	grep -q '^(.*, 1, 3)$' log || fail "$release: python3-rbsim reads other positions: $(tail -n 5 log)"
	{
		inside clean apt-get -qq purge -y python3-rbsim
		inside clean python3 -m venv /srv/venv
		inside clean /srv/venv/bin/pip install --quiet /srv/python
		inside clean sh -c 'cd /srv && venv/bin/python -c "
import rbsim
with rbsim.run(\"drop.lua\") as run: print(run.position.shape)"'
	} >log 2>&1 || fail "$release: pip install tools/python: $(tail -n 20 log)"
	grep -q '^(.*, 1, 3)$' log || fail "$release: another run through the package of pip: $(tail -n 5 log)"
	inside clean sh -c 'apt-get -qq purge -y "rbsim*" "librbsim*" && ! command -v rbsim && ! ls -d /usr/*/rbsim 2>/dev/null' >log 2>&1 ||
		fail "$release: something of the packages is left: $(cat log)"

	# the Apptainer recipe's own steps: its files, %post, %test
	mkdir -p clean/src
	git clone --quiet --no-hardlinks "$TOP" clean/src/rbsim
	for section in post test; do
		awk -v section="%$section" '/^%/ { on = $0 == section; next } on' "$TOP/examples/cluster/rbsim.def" >clean/srv/$section
		inside clean sh -e /srv/$section >log 2>&1 || fail "$release: %$section of rbsim.def: $(tail -n 20 log)"
	done
	echo "$release: $(cd build/packages && echo *.deb), Python $(inside clean python3 -V | cut -d ' ' -f 2); built in $((built - began)) s, tried in $(($(date +%s) - built)) s"
	rm -rf build clean
done
