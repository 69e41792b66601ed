BEGIN TRANSACTION;
CREATE TABLE links (
	token VARCHAR NOT NULL, 
	run_id VARCHAR NOT NULL, 
	until DOUBLE NOT NULL, 
	PRIMARY KEY (token), 
	FOREIGN KEY(run_id) REFERENCES runs (id) ON DELETE CASCADE
);
INSERT INTO "links" VALUES('llllllllllllllllllllllll','rrrrrrrrrrrrrrrrrrrrrrrr',4000000000.0);
CREATE TABLE places (
	id VARCHAR NOT NULL, 
	person VARCHAR NOT NULL, 
	node VARCHAR NOT NULL, 
	seen DOUBLE NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "places" VALUES('pppppppppppppppppppppppp','user ada','old',1700000000.0);
CREATE TABLE runs (
	id VARCHAR NOT NULL, 
	owner VARCHAR NOT NULL, 
	kind VARCHAR NOT NULL, 
	title TEXT NOT NULL, 
	state VARCHAR NOT NULL, 
	request TEXT NOT NULL, 
	outcome TEXT NOT NULL, 
	message TEXT NOT NULL, 
	created DOUBLE NOT NULL, 
	size INTEGER NOT NULL, 
	favourite BOOLEAN NOT NULL, 
	node VARCHAR NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "runs" VALUES('rrrrrrrrrrrrrrrrrrrrrrrr','user ada','generate','Two people hug.','done','{"kind": "generate", "prompt": "Two people hug."}','{}','',1700000000.0,5000,1,'old');
CREATE TABLE sign_ins (
	digest VARCHAR NOT NULL, 
	person VARCHAR NOT NULL, 
	until DOUBLE NOT NULL, 
	PRIMARY KEY (digest)
);
INSERT INTO "sign_ins" VALUES('dddddddddddddddddddddddddddddddddddddddddddddddddddddddddddddddd','ada',4000000000.0);
CREATE TABLE work (
	person VARCHAR NOT NULL, 
	node VARCHAR NOT NULL, 
	units DOUBLE NOT NULL, 
	seen DOUBLE NOT NULL, 
	PRIMARY KEY (person, node)
);
INSERT INTO "work" VALUES('user ada','old',12.5,1700000000.0);
CREATE INDEX ix_runs_state ON runs (state);
CREATE INDEX ix_runs_created ON runs (created);
CREATE INDEX ix_runs_owner ON runs (owner);
CREATE INDEX ix_sign_ins_person ON sign_ins (person);
CREATE INDEX ix_places_person ON places (person);
CREATE INDEX ix_places_node ON places (node);
CREATE INDEX ix_work_seen ON work (seen);
CREATE INDEX ix_links_run_id ON links (run_id);
COMMIT;
