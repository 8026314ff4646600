raise SystemExit("this is not run")
