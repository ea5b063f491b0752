world { duration = 1 }
os.exit(0)
-- expect: :2: attempt to index a nil value (global 'os') (scenes reach no files or programs; record { } says what is written)
