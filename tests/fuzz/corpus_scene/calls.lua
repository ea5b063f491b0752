world { duration = 1 }
expect("text")
expect_always(function() end, "text")
on_step(3)
on_frame()
expect_refused("65")
reference {}
param("a", {})
param(1, 2)
param("b", 5, "help", { min = 6 })
param("b", 5, 3, { mn = 1 })
param("c", "x", "help", { choices = {"y", "z"} })
param("d", true, "help", { min = 0, choices = {} })
sphere { radius = 1 }
