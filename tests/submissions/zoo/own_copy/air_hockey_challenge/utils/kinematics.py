def forward_kinematics(mj_model, mj_data, q, link="ee"):
    raise NotImplementedError
