world { duration = 1 }
sphere { radius = = 1 }
-- expect: :2: unexpected symbol near '='
