BEGIN TRANSACTION;
CREATE TABLE ballots (
	rater_id INTEGER NOT NULL, 
	pair INTEGER NOT NULL, 
	ticket VARCHAR NOT NULL, 
	swapped BOOLEAN NOT NULL, 
	shown DOUBLE NOT NULL, 
	answer VARCHAR NOT NULL, 
	answered DOUBLE NOT NULL, 
	PRIMARY KEY (rater_id, pair), 
	FOREIGN KEY(rater_id) REFERENCES raters (id) ON DELETE CASCADE
);
INSERT INTO "ballots" VALUES(1,0,'tttttttttttttttttttttttt',0,1700000000.0,'first',1700000000.0);
CREATE TABLE ledger (
	id INTEGER NOT NULL, 
	elapsed DOUBLE NOT NULL, 
	wall DOUBLE NOT NULL, 
	accepted DOUBLE NOT NULL, 
	doubted DOUBLE, 
	ahead DOUBLE NOT NULL, 
	turn INTEGER NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "ledger" VALUES(1,1700000000.0,1700000000.0,0.0,NULL,0.0,0);
CREATE TABLE links (
	token VARCHAR NOT NULL, 
	run_id VARCHAR NOT NULL, 
	until DOUBLE NOT NULL, 
	PRIMARY KEY (token), 
	FOREIGN KEY(run_id) REFERENCES runs (id) ON DELETE CASCADE
);
INSERT INTO "links" VALUES('llllllllllllllllllllllll','rrrrrrrrrrrrrrrrrrrrrrrr',4000000000.0);
CREATE TABLE notes (
	run_id VARCHAR NOT NULL, 
	title TEXT NOT NULL, 
	tags TEXT NOT NULL, 
	text TEXT NOT NULL, 
	frame INTEGER, 
	thumbnail TEXT NOT NULL, 
	kept TEXT NOT NULL, 
	part_of VARCHAR NOT NULL, 
	removed DOUBLE, 
	PRIMARY KEY (run_id), 
	FOREIGN KEY(run_id) REFERENCES runs (id) ON DELETE CASCADE
);
INSERT INTO "notes" VALUES('rrrrrrrrrrrrrrrrrrrrrrrr','The hug',' close ','at last',3,'','','',NULL);
CREATE TABLE places (
	id VARCHAR NOT NULL, 
	person VARCHAR NOT NULL, 
	node VARCHAR NOT NULL, 
	seen DOUBLE NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "places" VALUES('pppppppppppppppppppppppp','user ada','old',1700000000.0);
CREATE TABLE raters (
	id INTEGER NOT NULL, 
	study_id VARCHAR NOT NULL, 
	person VARCHAR NOT NULL, 
	address VARCHAR NOT NULL, 
	"plan" TEXT NOT NULL, 
	PRIMARY KEY (id), 
	UNIQUE (study_id, person), 
	FOREIGN KEY(study_id) REFERENCES studies (id) ON DELETE CASCADE
);
INSERT INTO "raters" VALUES(1,'555555555555555555555555','pppppppppppppppppppppppppppppppp','','[0]');
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
	stored DOUBLE DEFAULT '0' NOT NULL, 
	size INTEGER NOT NULL, 
	address VARCHAR DEFAULT '' NOT NULL, 
	favourite BOOLEAN NOT NULL, 
	node VARCHAR NOT NULL, 
	PRIMARY KEY (id)
);
INSERT INTO "runs" VALUES('rrrrrrrrrrrrrrrrrrrrrrrr','user ada','generate','Two people hug.','done','{"kind": "generate", "prompt": "Two people hug."}','{}','',1700000000.0,0.0,5000,'',1,'old');
CREATE TABLE sessions (
	digest VARCHAR NOT NULL, 
	person VARCHAR NOT NULL, 
	entry VARCHAR NOT NULL, 
	until DOUBLE NOT NULL, 
	PRIMARY KEY (digest)
);
INSERT INTO "sessions" VALUES('dddddddddddddddddddddddddddddddddddddddddddddddddddddddddddddddd','ada','eeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeeee',4000000000.0);
CREATE TABLE studies (
	id VARCHAR NOT NULL, 
	owner VARCHAR NOT NULL, 
	"key" VARCHAR NOT NULL, 
	title TEXT NOT NULL, 
	question TEXT NOT NULL, 
	sets TEXT NOT NULL, 
	pairs TEXT NOT NULL, 
	pairs_each INTEGER NOT NULL, 
	shows_sentence BOOLEAN NOT NULL, 
	shows_result BOOLEAN NOT NULL, 
	closed BOOLEAN NOT NULL, 
	created DOUBLE NOT NULL, 
	size INTEGER NOT NULL, 
	address VARCHAR DEFAULT '' NOT NULL, 
	PRIMARY KEY (id), 
	UNIQUE ("key")
);
INSERT INTO "studies" VALUES('555555555555555555555555','user ada','kkkkkkkkkkkkkkkkkkkkkkkk','Which?','Which is closer?','["a", "b"]','[]',1,1,0,0,1700000000.0,100,'');
CREATE TABLE work (
	person VARCHAR NOT NULL, 
	node VARCHAR NOT NULL, 
	units DOUBLE NOT NULL, 
	seen DOUBLE NOT NULL, 
	PRIMARY KEY (person, node)
);
INSERT INTO "work" VALUES('user ada','old',12.5,1700000000.0);
CREATE INDEX ix_runs_created ON runs (created);
CREATE INDEX ix_runs_stored ON runs (stored);
CREATE INDEX ix_runs_owner ON runs (owner);
CREATE INDEX ix_runs_state ON runs (state);
CREATE INDEX ix_runs_address ON runs (address);
CREATE INDEX ix_sessions_person ON sessions (person);
CREATE INDEX ix_studies_address ON studies (address);
CREATE INDEX ix_studies_owner ON studies (owner);
CREATE INDEX ix_places_person ON places (person);
CREATE INDEX ix_places_node ON places (node);
CREATE INDEX ix_work_seen ON work (seen);
CREATE INDEX ix_notes_removed ON notes (removed);
CREATE INDEX ix_notes_part_of ON notes (part_of);
CREATE INDEX ix_links_run_id ON links (run_id);
CREATE INDEX ix_raters_study_id ON raters (study_id);
COMMIT;
