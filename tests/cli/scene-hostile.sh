#!/bin/sh
# SPDX-License-Identifier: MIT
# Scenes that would take the stack of C or walk patterns without end are refused with a status, never by a signal.
. tests/cli/functions

# refused NAME PATTERN, the scene on standard input
refused()
{
	cat >"$1.lua"
	exits 65 check "$1.lua"
	says err "$2"
}

refused close 'closed in each other more than' <<'END'
local before
for i = 1, 100000 do
	local inner = before
	local co = coroutine.create(function()
		local x <close> = setmetatable({}, { __close = function()
			if inner then
				local ok, err = coroutine.close(inner)
				if not ok then error(err, 0) end
			end
		end })
		coroutine.yield()
	end)
	coroutine.resume(co)
	before = co
end
local ok, err = coroutine.close(before)
if not ok then error(err, 0) end
END
refused set 'too many steps|million instructions' <<'END'
local set = "[" .. ("a"):rep(1000000) .. "]"
local text = ("b"):rep(1000000)
text:find(set .. "*x")
END
refused frontier 'too many steps|million instructions' <<'END'
local text = ("b"):rep(1000000)
text:find("%f[" .. ("a"):rep(1000000) .. "]")
END
refused skipped 'too many steps|million instructions' <<'END'
local text = ("b"):rep(1000000)
text:gsub("[^" .. ("b"):rep(1000000) .. "]?x", "")
END
exit 0
