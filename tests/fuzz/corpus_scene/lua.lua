local t = setmetatable({}, { __index = function(t, k) return k end, __close = print })
for k, v in pairs { a = 1, [2] = 3, [1.5] = true } do print(k, v, next({})) end
local co = coroutine.wrap(function(...) coroutine.yield(...) error({}) end)
print(pcall(co, 1), pcall(co), xpcall(error, tostring, "x"), select("#", table.unpack({1, 2, 3})))
print(("a=1"):gsub("(%w+)=(%w+)", "%2%1"), ("x"):rep(3, ","), ("%s %d"):format(t, 3), ("f(a)"):match("%b()"))
for w in ("one two"):gmatch("%f[%a]%a+") do table.insert(t, 1, w) end table.sort(t) table.concat(t, ",")
print(require "part".radius, math.random(3), tostring(vec3(1, 2, 3) * 2 - {1, 1, 1}), utf8.char(233), box {})
local x <close> = t
