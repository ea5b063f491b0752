world { duration = 1 }
jointly()
-- expect: :2: attempt to call a nil value (global 'jointly')
