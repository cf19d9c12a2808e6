!> The structure of a set before anything is solved: the blocks of its independent mechanisms, which their engines take
!> over, its counts, its Assur groups, and what it lacks or has too much of, in words and by name.
!>
!> (12)  r = 2 (n1 + n2) + 3 n3
!> (13)  s = 3 n - r        (the print subtracts 2 n1 + n2 only)
module structure
   use kinds, only: label_length
   use cards, only: forms, form_ground
   use failures, only: failure_t, fail, status_rejected
   use numerals, only: whole
   use names, only: drive_name, listed
   use grouping, only: sorted_t, sorted, members, once, joined
   use mechanism, only: mechanism_t, pair_links, drive_links, pair_revolute, pair_prismatic, method_newton
   use matching, only: incidence_t, match, owners, overdetermined, underdetermined
   use assur_groups, only: closure_t, new_closure, group_t, groups_of
   use independent, only: set_t, divide, part_of_links
   use links_tree, only: tree_t
   use block_structure, only: structure_t, make_structure
   implicit none
   private
   public :: structure_t, findings_t, group_t, underdetermined_t, make_structure, find_structure, &
      find_groups, check_structure, faults_text, spare_drives_text

   !> Links that still can move, and the drives that they lack.
   type :: underdetermined_t
      integer, allocatable :: links(:)
      integer :: degrees_of_freedom = 0
   end type underdetermined_t

   type :: findings_t
      integer :: links = 0        !< n, ground links with them
      integer :: ground = 0       !< n3
      integer :: revolute = 0     !< n1
      integer :: prismatic = 0    !< n2
      integer :: coordinates = 0  !< w = 3 n
      integer :: equations = 0    !< r
      integer :: degrees_of_freedom = 0     !< s
      integer :: drives = 0       !< number of drives
      logical :: solvable = .false.             !< every unknown has an equation of its own
      type(underdetermined_t), allocatable :: lacking(:)   !< what still can move
      integer :: spare_drives = 0               !< drives that are too many, among those of
      integer, allocatable :: spare_among(:)    !< (any number) where there are such drives
      integer :: redundant = 0                  !< equations that are too many, among those of
      integer, allocatable :: many_pairs(:), many_drives(:)
      type(group_t), allocatable :: groups(:)   !< in solving order, once `find_groups` has been asked for them
      ! Of the independent mechanisms, where nothing is lacking:
      type(set_t), allocatable :: set                   !< divided, where it is several
      type(structure_t), allocatable :: structures(:)   !< (parts)
   end type findings_t

   !> So many parts are named; of more, the number is given.
   integer, parameter :: max_parts = 20

   !> So many prismatic pairs at joints are named in a line.
   integer, parameter :: max_shared = 4

   !> The faults of so many sets are reported.
   integer, parameter :: max_sets = 10

contains

   !> The counts (12) and (13) of `m`, and what its structure lacks or has too much of.
   function find_structure(m) result(f)
      type(mechanism_t), intent(in) :: m
      type(findings_t) :: f
      type(closure_t) :: c
      type(structure_t) :: whole
      integer, allocatable :: unknown_of(:), equation_of(:)
      logical, allocatable :: over(:)
      integer :: k, parts

      f%links = size(m%links)
      f%ground = count(m%links%ground)
      f%revolute = count(m%pairs%kind == pair_revolute)
      f%prismatic = count(m%pairs%kind == pair_prismatic)
      f%coordinates = 3*f%links
      f%equations = 2*(f%revolute + f%prismatic) + 3*f%ground
      f%degrees_of_freedom = f%coordinates - f%equations
      f%drives = size(m%drives)

      c = new_closure(m)
      call match(c%incidence, unknown_of, equation_of)
      over = overdetermined(c%incidence, unknown_of, equation_of)
      f%redundant = count(unknown_of == 0)
      f%many_pairs = pack(c%pair, over .and. c%pair > 0)
      f%many_drives = pack(c%drive, over .and. c%drive > 0)
      if (size(f%many_drives) > 1) call find_spare_drives()
      if (any(equation_of == 0)) then
         f%lacking = parts_that_lack(underdetermined(c%incidence, unknown_of, equation_of))
         return
      end if
      allocate (f%lacking(0))
      parts = max(1, maxval([0, part_of_links(m)]))
      allocate (f%structures(parts))
      if (parts == 1) then
         call make_structure(m, f%structures(1))
      else
         allocate (f%set)
         call divide(m, f%set)
         do k = 1, parts
            call make_structure(f%set%parts(k), f%structures(k))
         end do
      end if
      f%solvable = all([(f%structures(k)%blocks%solvable, k=1, size(f%structures))])
      if (.not. f%solvable) then
         call make_structure(m, whole)
         f%lacking = parts_on_tree(whole%blocks%tree, whole%blocks%free)
      end if

   contains

      !> Finds the drives of `f` that are too many: in each independent mechanism of `m` as many as there are
      !> equations that are too many with its drives and not without.
      subroutine find_spare_drives()
         type(incidence_t) :: of_pairs
         integer, allocatable :: part(:), part_of(:), alone(:), by_pairs(:), spare(:), many(:)
         logical :: is_many(size(over))
         integer :: e

         ! The equations of pairs come before those of drives.
         of_pairs = c%incidence
         of_pairs%equations = count(c%pair > 0)
         call match(of_pairs, alone, by_pairs)
         part = part_of_links(m)
         part_of = part(c%link_of(c%incidence%unknown(c%incidence%first(:size(over)))))
         is_many = over .and. c%drive > 0
         allocate (spare(maxval(part)), many(maxval(part)), source=0)
         do e = 1, size(over)
            associate (i => part_of(e))
               if (unknown_of(e) == 0) spare(i) = spare(i) + 1
               if (is_many(e)) many(i) = many(i) + 1
               if (e > size(alone)) cycle
               if (alone(e) == 0) spare(i) = spare(i) - 1
            end associate
         end do
         ! The pairs of a mechanism that moves against its count leave no drive: those are not too many.
         where (spare >= many) spare = 0
         f%spare_drives = sum(spare)
         f%spare_among = pack(c%drive, is_many .and. spare(part_of) > 0)
      end subroutine find_spare_drives

      !> The parts of `m` that still can move: the links of coordinates that have too few equations (`loose`), those in
      !> one part that such coordinates in one equation join. `equation_of` (unknowns): the matching of the closure `c`.
      function parts_that_lack(loose) result(parts)
         logical, intent(in) :: loose(:)
         type(underdetermined_t), allocatable :: parts(:)
         logical :: can_move(size(m%links))
         integer, allocatable :: unknown(:), part(:)
         type(sorted_t) :: by_part
         integer :: i

         can_move = .false.
         can_move(pack(c%link_of, loose)) = .true.
         associate (g => c%incidence)
            unknown = g%unknown(:g%first(g%equations + 1) - 1)
            ! Behind the links the equations.
            part = joined([can_move, spread(.true., 1, g%equations)], c%link_of(pack(unknown, loose(unknown))), &
               size(m%links) + pack(owners(g), loose(unknown)))
         end associate
         part = part(:size(m%links))
         allocate (parts(maxval([0, part])))
         by_part = sorted(part, size(parts))
         do i = 1, size(parts)
            parts(i)%links = members(by_part, i)
         end do
         do i = 1, size(equation_of)
            if (equation_of(i) > 0) cycle
            associate (degrees => parts(part(c%link_of(i)))%degrees_of_freedom)
               degrees = degrees + 1
            end associate
         end do
      end function parts_that_lack

      !> Finds these parts by unknowns of the tree that found no equation: two links that a prismatic pair joins
      !> have one angle.
      function parts_on_tree(t, free) result(parts)
         type(tree_t), intent(in) :: t
         integer, intent(in) :: free(:)
         type(underdetermined_t), allocatable :: parts(:)
         integer :: i, k
         logical :: is_free(size(m%links))

         allocate (parts(0))
         do k = 1, size(free)
            if (free(k) <= t%orientations) then
               is_free = t%orientation == free(k)
            else if (free(k) <= t%orientations + t%slides) then
               is_free = t%parent_joint == findloc(t%slide, free(k) - t%orientations, dim=1)
            else
               is_free = t%root == (free(k) - t%orientations - t%slides + 1)/2
            end if
            parts = [parts, underdetermined_t(pack([(i, i=1, size(m%links))], is_free), 1)]
         end do
      end function parts_on_tree
   end function find_structure

   !> Finds the groups of `m`, whose findings `f` are; none where it is not solvable. Only the listing has them, and the
   !> sets of a long job are checked one after another, but listed by several processes.
   subroutine find_groups(m, f)
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(inout) :: f

      if (.not. allocated(f%groups)) allocate (f%groups(0))
      if (f%solvable) f%groups = groups_of(m, new_closure(m))
   end subroutine find_groups

   !> Every link of every set can be found: `findings` (sets).
   subroutine check_structure(sets, findings, failure)
      type(mechanism_t), intent(in) :: sets(:)
      type(findings_t), allocatable, intent(out) :: findings(:)
      type(failure_t), allocatable, intent(out) :: failure
      character(:), allocatable :: text, all_of_them
      integer :: i, reported

      allocate (findings(size(sets)))
      all_of_them = ''
      reported = 0
      do i = 1, size(sets)
         findings(i) = find_structure(sets(i))
         text = faults_text(sets(i), findings(i), sets(i)%set_number)
         if (len(text) == 0) cycle
         if (reported > 0) all_of_them = all_of_them//new_line('a')//' *** '
         all_of_them = all_of_them//text
         reported = reported + 1
         if (reported == max_sets) exit
      end do
      if (reported > 0) call fail(failure, status_rejected, all_of_them)
   end subroutine check_structure

   !> A line for each fault of set number `set`, joined by new_line('a'); '' where there is none.
   function faults_text(m, f, set) result(text)
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: f
      integer, intent(in) :: set
      character(:), allocatable :: text
      integer :: i, k

      text = ''
      if (size(f%lacking) == 0) then
         if (f%redundant > 0 .and. m%method /= method_newton) then
            call add_line('E104  SET '//whole(set)//': ONLY METHOD NEWTON TAKES '//surplus(m, f))
            call add_spare_drives('TAKE IT AWAY')
         end if
         return
      end if
      if (f%ground == 0) then
         call add_line('E105  SET '//whole(set)//': NO LINK IS GROUND: GIVE IT A GROUND CARD')
         text = text//new_line('a')//' LAYOUT    |'//trim(forms(form_ground)%layout)
      end if
      do i = 1, min(size(f%lacking), max_parts)
         associate (one => f%lacking(i))
            call add_line('E101  SET '//whole(set)//': '//counted('LINK', m%links(one%links)%name)//': ' &
               //whole(one%degrees_of_freedom)//' ' &
               //trim(merge('DEGREE OF FREEDOM NOT DRIVEN: ADD A DRIVE OR A PAIR', &
               'DEGREES OF FREEDOM NOT DRIVEN: ADD DRIVES OR PAIRS ', one%degrees_of_freedom == 1)) &
               //shared_joints(m, [(k, k=1, size(m%pairs))], one%links))
         end associate
      end do
      if (size(f%lacking) > max_parts) call add_line('E101  SET '//whole(set)//': AND ' &
         //whole(size(f%lacking) - max_parts)//' MORE PARTS THAT CAN MOVE')
      call add_open_ends()
      if (f%redundant > 0) call add_line('E102  SET '//whole(set)//': '//surplus(m, f) &
         //shared_joints(m, once(f%many_pairs)))
      call add_spare_drives('DRIVE THE LINKS OF E101')
      call add_line('E103  SET '//whole(set)//': W = '//whole(f%coordinates)//' COORDINATES LESS R = ' &
         //whole(f%equations)//' EQUATIONS LEAVE S = '//whole(f%degrees_of_freedom) &
         //' DEGREES OF FREEDOM, DRIVES ARE '//whole(f%drives))

   contains

      !> Appends `line`.
      subroutine add_line(line)
         character(*), intent(in) :: line

         if (len(text) > 0) text = text//new_line('a')//' *** '
         text = text//line
      end subroutine add_line

      !> Appends the line on links that can move, are not driven and have fewer than two pairs, if a revolute pair more
      !> would hold no more than what is left to move.
      subroutine add_open_ends()
         integer :: pairs(size(m%links)), i
         logical :: is_open(size(m%links))

         if (sum(f%lacking%degrees_of_freedom) < 2) return
         pairs = 0
         do i = 1, size(m%pairs)
            associate (ends => pair_links(m, m%pairs(i)))
               pairs(ends) = pairs(ends) + 1
            end associate
         end do
         is_open = .false.
         do i = 1, size(f%lacking)
            is_open(f%lacking(i)%links) = pairs(f%lacking(i)%links) < 2
         end do
         do i = 1, size(m%drives)
            is_open(drive_links(m, m%drives(i))) = .false.
         end do
         if (any(is_open)) call add_line('E101  SET '//whole(set)//': NO SECOND PAIR HOLDS ' &
            //counted('LINK', pack(m%links%name, is_open))//': IS ONE FORGOTTEN?')
      end subroutine add_open_ends

      !> Appends the line on drives that are too many, and what `to_do`.
      subroutine add_spare_drives(to_do)
         character(*), intent(in) :: to_do

         if (f%spare_drives > 0) call add_line('E106  SET '//whole(set)//': TOO MANY DRIVES BY ' &
            //spare_drives_text(m, f, .false.)//'; '//to_do)
      end subroutine add_spare_drives
   end function faults_text

   !> How many drives are too many, and among which, in Polish or in English: 1: ANGLE CRANK, ANGLE ROCKER.
   function spare_drives_text(m, f, polish) result(text)
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: f
      logical, intent(in) :: polish
      character(:), allocatable :: text

      text = whole(f%spare_drives)//': '//listed(drive_names(m, f%spare_among), polish)
   end function spare_drives_text

   !> The names of the drives with these numbers.
   function drive_names(m, numbers) result(names)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: numbers(:)
      character(3*label_length + 2) :: names(size(numbers))
      integer :: i

      do i = 1, size(numbers)
         names(i) = drive_name(m, m%drives(numbers(i)))
      end do
   end function drive_names

   !> `word` and the `names` to which it applies: LINK A, or LINKS A, B.
   function counted(word, names) result(text)
      character(*), intent(in) :: word, names(:)
      character(:), allocatable :: text

      text = word//trim(merge(' ', 'S', size(names) == 1))//' '//listed(names, .false.)
   end function counted

   !> A sentence for each of `pairs` that is prismatic and has a point of a JOINT card: which of the two links of the
   !> joint it holds, and which not; '' if there is none. `links`: one of these two, not both, is among them.
   function shared_joints(m, pairs, links) result(text)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: pairs(:)
      integer, intent(in), optional :: links(:)
      character(:), allocatable :: text
      logical :: among(size(m%links))
      integer :: ends(2), i, k, other, told

      text = ''
      among = .false.
      if (present(links)) among(links) = .true.
      told = 0
      do i = 1, size(pairs)
         if (m%pairs(pairs(i))%kind /= pair_prismatic) cycle
         ends = [m%pairs(pairs(i))%point_i, m%pairs(pairs(i))%point_j]
         do k = 1, size(ends)
            ! The other point of a JOINT card stands beside it and has its name.
            do other = max(1, ends(k) - 1), min(ends(k) + 1, size(m%points))
               if (other == ends(k) .or. m%points(other)%name /= m%points(ends(k))%name) cycle
               associate (held => m%points(ends(k))%link, free => m%points(other)%link)
                  if (told == max_shared .or. (present(links) .and. (among(held) .eqv. among(free)))) cycle
                  told = told + 1
                  text = text//'; PAIR '//trim(m%pairs(pairs(i))%name)//' HOLDS LINK '//trim(m%links(held)%name) &
                     //' AT JOINT '//trim(m%points(other)%name)//', NOT LINK '//trim(m%links(free)%name) &
                     //': FOR '//trim(m%links(free)%name)//' NAME A POINT OF ITS OWN'
               end associate
            end do
         end do
      end do
   end function shared_joints

   !> TOO MANY EQUATIONS BY 1 AMONG PAIRS A, B AND DRIVES ...
   function surplus(m, f) result(text)
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: f
      character(:), allocatable :: text
      integer, allocatable :: pairs(:)

      pairs = once(f%many_pairs)
      text = 'TOO MANY EQUATIONS BY '//whole(f%redundant)//' AMONG '
      if (size(pairs) > 0) text = text//counted('PAIR', m%pairs(pairs)%name)
      if (size(pairs) > 0 .and. size(f%many_drives) > 0) text = text//' AND '
      if (size(f%many_drives) > 0) text = text//counted('DRIVE', drive_names(m, f%many_drives))
   end function surplus

end module structure
