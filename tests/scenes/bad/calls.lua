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
param("e", 1, "help", { min = 2, max = 0 })
sphere { radius = 1 }
-- expect: :2: expect: expected a text and a function (got nothing for the function)
-- expect: :3: expect_always: expected a text and a function (got a function for the text)
-- expect: :4: on_step: expected a function (got 3)
-- expect: :5: on_frame: expected a function (got nothing)
-- expect: :6: expect_refused: expected an exit status of rbsim(1) first, like 65 (got the text '65')
-- expect: :7: reference: expected a function of t (got {})
-- expect: :8: param 'a': the default must be a number, a boolean or a text (got {})
-- expect: :9: param: expected a name, a default, a help text (got 1 for the name)
-- expect: :10: param 'b': the default must be at least 6 (got 5)
-- expect: :11: param 'b': the help must be a text (got 3)
-- expect: :11: param 'b': the parameter was declared before
-- expect: :11: param 'b': unknown key 'mn' (did you mean 'min'?)
-- expect: :12: param 'c': the default must be one of y, z (got x)
-- expect: :13: param 'd': 'min' and 'max' are for numbers
-- expect: :13: param 'd': 'choices' must be a list of numbers, texts or booleans (got {})
-- expect: :14: param 'e': 'min' 2 is above 'max' 0
