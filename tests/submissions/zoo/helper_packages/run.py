print("python run.py")
