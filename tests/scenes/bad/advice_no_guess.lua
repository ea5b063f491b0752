world { duration = 1 }
quickly()
-- expect: :2: attempt to call a nil value (global 'quickly')
