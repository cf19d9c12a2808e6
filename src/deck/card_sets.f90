!> One set of computations while it is read: its cards, the deck's errors, and the mechanism that is built at END. Here
!> are links, points and pairs. A card may use a name before the card that defines the name, so all names are looked up
!> at END.
module card_sets
   use kinds, only: wp
   use mechanism
   use cards
   use card_reader, only: parsed_card_t, find_long_label
   use input_errors
   use parameters, only: angle_in_radians
   use drawn_values, only: complete_from_drawing, coincides
   use drawn_lengths, only: set_axes, same_place_tolerance
   use name_table, only: name_table_t, store_name, find_name
   use names, only: subject_name
   use number_format, only: whole
   implicit none
   private
   public :: card_set_t, begin_set, begin_mechanism, build_bodies, define_name, has_drawing, joint_points, look_up, &
      look_up_kinds, match_word
   public :: add_card_error, add_card_remark, real_text

   !> The links, the points, the pairs or the measures of a set, by number and by name.
   type :: named_t
      integer, allocatable :: card(:)               !< (members) the numbers of the cards that define them
      type(name_table_t) :: table                   !< from their names to their numbers: indices in `card`
   end type named_t

   !> The open set of computations.
   type :: card_set_t
      integer :: count = 0                          !< cards so far
      type(parsed_card_t), allocatable :: cards(:)  !< (count or more) the first `count` are in use
      integer :: number_of(0:form_end) = 0          !< cards of each form
      logical :: names_certain = .true.             !< of every card: no unknown name can be a misread one
      type(named_t) :: named(request_link:request_measure)   !< by kind
      type(mechanism_t) :: mechanism                !< made of the cards
      type(mechanism_t), allocatable :: drawing     !< `mechanism` before lengths; without lengths not allocated
      type(input_errors_t) :: errors                !< all errors of the deck so far
   end type card_set_t

   !> Characters of the longest text of a real: a field of a `*` card.
   integer, parameter :: real_length = wide_fields(1)%last - wide_fields(1)%first + 1
   !> A form of the cards that define a link, point, pair or measure (`kind`), and the label field with its name.
   type :: definer_t
      integer :: kind = 0, form = 0, label = label_a
   end type definer_t
   !> All forms of cards that define something. A JOINT card defines two points and a pair.
   type(definer_t), parameter :: definers(*) = [ &
      definer_t(request_link, form_ground), definer_t(request_link, form_link), definer_t(request_point, form_point), &
      definer_t(request_point, form_joint), definer_t(request_point, form_joint), &
      definer_t(request_pair, form_revolute, label_c), definer_t(request_pair, form_prism, label_c), &
      definer_t(request_pair, form_slot, label_c), definer_t(request_pair, form_cylinder, label_c), &
      definer_t(request_pair, form_joint), &
      definer_t(request_measure, form_distance, label_c), definer_t(request_measure, form_line, label_c), &
      definer_t(request_measure, form_angle, label_c), definer_t(request_measure, form_xi, label_c), &
      definer_t(request_measure, form_eta, label_c), definer_t(request_measure, form_sum, label_c)]
   !> The errors of names that no link, no point, no pair, no measure has.
   type(error_code_t), parameter :: unknown(request_link:request_measure) = &
      [link_unknown, point_unknown, pair_unknown, measure_unknown]
   !> The words of the kinds in messages.
   character(*), parameter :: words_of_kinds(request_link:request_measure) = &
      [character(7) :: 'LINK', 'POINT', 'PAIR', 'MEASURE']

contains

   !> Empties a set for the next set of computations of the deck. The errors of the deck stay.
   subroutine begin_set(set, number)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: number          !< of the set in the deck, from 1

      if (.not. allocated(set%cards)) allocate (set%cards(64))
      set%count = 0
      set%number_of = 0
      set%names_certain = .true.
      call begin_mechanism(set, number)
   end subroutine begin_set

   !> Makes a set ready to build its mechanism from its cards, for the first time or again.
   subroutine begin_mechanism(set, number)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: number          !< of the set in the deck, from 1
      integer :: kind

      if (set%count > 0) set%cards(:set%count)%subject = 0
      do kind = request_link, request_measure
         set%named(kind) = named_t()
      end do
      set%mechanism = mechanism_t(set_number=number)
      if (allocated(set%drawing)) deallocate (set%drawing)
   end subroutine begin_mechanism

   !> Finds the label field, label_a to label_c, in which the cards of a form have the name that they define.
   pure integer function name_field(form)
      integer, intent(in) :: form            !< of cards that define a name: form_ground, ...

      name_field = definers(findloc(definers%form, form, dim=1))%label
   end function name_field

   !> Builds the links, points and pairs of a mechanism, each kind in the order of its cards. After them come the block
   !> of each SLOT card, a point of the block, and its revolute pair. Errors are repeated and unknown names, and pairs
   !> that do not join two links.
   subroutine build_bodies(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      real(wp) :: unit
      integer :: defined(form_unknown:form_end)   ! members of the kind that a card of the form defines
      integer :: kind, n, k, i, slots

      unit = angle_in_radians(set%mechanism)
      do kind = request_link, request_measure
         ! In the order of the deck; a card that defines two members is there twice.
         defined = 0
         do i = 1, size(definers)
            if (definers(i)%kind == kind) defined(definers(i)%form) = defined(definers(i)%form) + 1
         end do
         set%named(kind)%card = pack([(k, k, k=1, set%count)], &
            [(defined(set%cards(k)%form) > 0, defined(set%cards(k)%form) > 1, k=1, set%count)])
      end do
      associate (blocks => set%number_of(form_slot))
         allocate (set%mechanism%links(size(set%named(request_link)%card) + blocks))
         allocate (set%mechanism%points(size(set%named(request_point)%card) + blocks))
         allocate (set%mechanism%pairs(size(set%named(request_pair)%card) + blocks))
      end associate

      do n = 1, size(set%named(request_link)%card)
         associate (card => set%cards(set%named(request_link)%card(n)))
            set%mechanism%links(n) = link_t(name=card%label(label_a), ground=card%form == form_ground, &
               position=card%real*[1.0_wp, 1.0_wp, unit])
         end associate
         call define_name(set, request_link, n)
      end do
      do n = 1, size(set%named(request_point)%card)
         call build_point(set, n)
      end do
      do n = 1, size(set%named(request_link)%card)
         if (any(set%cards(set%named(request_link)%card(n))%label(label_b:) /= '')) call find_bar(set, n)
      end do
      call set_axes(set%mechanism, reshape([(set%mechanism%points(i)%place, i=1, size(set%mechanism%points))], &
         [2, size(set%mechanism%points)]))

      slots = 0
      do n = 1, size(set%named(request_pair)%card)
         call build_pair()
      end do

   contains

      !> Builds pair number `n` from its REVOLUTE, PRISM, SLOT, CYLINDER or JOINT card. The points must have been built.
      !> A pair that does not join two links, or joins two ground links, is an error.
      subroutine build_pair()
         real(wp) :: numbers(3)
         integer :: k, i, j

         k = set%named(request_pair)%card(n)
         if (set%cards(k)%form == form_joint) then
            i = set%cards(k)%subject
            j = i + 1
         else
            call look_up(set, request_point, k, label_a, i)
            call look_up(set, request_point, k, label_b, j)
         end if

         associate (card => set%cards(k), pair => set%mechanism%pairs(n))
            pair = pair_t(name=card%label(name_field(card%form)), point_i=i, point_j=j)
            if (any(card%form == [form_prism, form_slot])) then
               numbers = card%real*[unit, 1.0_wp, unit]
               pair = pair_t(pair_prismatic, pair%name, i, j, numbers(1), numbers(2), numbers(3), &
                  [.false., .not. card%given(2:) .and. has_drawing(set)])
            end if
            if (card%form == form_cylinder) then
               pair = pair_t(pair_prismatic, pair%name, i, j, drawn=.true., is_cylinder=.true.)
               where (card%given(:2)) pair%stroke = card%real(:2)
               if (card%given(1) .and. .not. card%real(1) > 0.0_wp) then
                  call add_card_error(set, number_range, k, real_1, 'ABOVE 0.0')
               else if (card%given(2) .and. .not. card%real(2) > 0.0_wp) then
                  call add_card_error(set, number_range, k, real_2, 'ABOVE 0.0')
               else if (.not. pair%stroke(1) < pair%stroke(2)) then
                  call add_card_error(set, cylinder_stroke, k, real_2)
               end if
            end if
         end associate

         if (set%cards(k)%form == form_slot) call build_block(n, j)
         if (set%cards(k)%form == form_cylinder .and. .not. has_drawing(set)) &
            call add_card_error(set, cylinder_drawing, k, card_name)
         call define_name(set, request_pair, n)

         if (i == 0 .or. j == 0) return
         i = set%mechanism%points(i)%link
         j = set%mechanism%points(j)%link
         if (i == 0 .or. j == 0) return
         if (i == j .or. (set%mechanism%links(i)%ground .and. set%mechanism%links(j)%ground)) then
            call add_card_error(set, pair_one_link, k, label_c)
         else if (any(set%mechanism%pairs(n)%drawn) .or. set%mechanism%pairs(n)%pin > 0) then
            ! Numbers as drawn. The points of a cylinder must lie apart.
            call complete_from_drawing(set%mechanism, n)
            if (set%mechanism%pairs(n)%drawn(1) .and. coincides(set%mechanism, set%mechanism%pairs(n))) &
               call add_card_error(set, cylinder_points, k, label_b)
         end if
      end subroutine build_pair

      !> Builds the block of a SLOT card: its link, its point, and its revolute pair with the pin. The block slides
      !> along the guide of link i and turns about the pin.
      subroutine build_block(n, pin)
         integer, intent(in) :: n            !< number of the card's pair
         integer, intent(in) :: pin          !< number of the point in the slot; 0: not known

         slots = slots + 1
         associate (m => set%mechanism, pair => set%mechanism%pairs(n), &
            link => size(set%named(request_link)%card) + slots, point => size(set%named(request_point)%card) + slots)
            m%links(link)%hidden = .true.
            m%points(point)%link = link
            m%pairs(size(set%named(request_pair)%card) + slots) = pair_t(name=pair%name, point_i=point, point_j=pin)
            pair%point_j = point
            pair%pin = pin
            pair%drawn(3) = .false.
         end associate
      end subroutine build_block
   end subroutine build_bodies

   !> Builds a point of a POINT card, or one of the two points of a JOINT card, which gives their position in the
   !> drawing. Both points of a JOINT card have its name; in the table of names the name stands for the point of the
   !> first link that is not ground. The links must have been built.
   subroutine build_point(set, n)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: n               !< number of the point
      integer :: k, link
      logical :: is_first, is_ground

      k = set%named(request_point)%card(n)
      if (set%cards(k)%form /= form_joint) then
         call define_name(set, request_point, n)
         call look_up(set, request_link, k, label_b, link)
         set%mechanism%points(n) = point_t(set%cards(k)%label(label_a), link, set%cards(k)%real(1:2))
         return
      end if
      is_first = set%cards(k)%subject == 0
      if (is_first) set%cards(k)%subject = n
      call look_up(set, request_link, k, merge(label_b, label_c, is_first), link)
      associate (m => set%mechanism, position => set%cards(k)%real(1:2))
         m%points(n) = point_t(name=set%cards(k)%label(label_a), link=link, place=position, drawn=.true.)
         link = m%points(set%cards(k)%subject)%link
         is_ground = .false.
         if (link > 0) is_ground = m%links(link)%ground
      end associate
      if (is_first .neqv. is_ground) call define_name(set, request_point, n)
   end subroutine build_point

   !> Finds the joints FROM and TO of a link at which its axes begin and to which they point. Numbers on the LINK card
   !> take precedence over these axes. The points must have been built. Joints that are not of the link, only one joint,
   !> and joints at one position are errors.
   subroutine find_bar(set, n)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: n               !< number of the link
      integer :: ends(2), k, label, one, i

      k = set%named(request_link)%card(n)
      if (set%cards(k)%form /= form_link .or. .not. set%cards(k)%valid) return
      ends = 0
      do label = label_b, label_c
         if (set%cards(k)%label(label) == '') cycle
         if (.not. has_drawing(set)) then
            if (set%names_certain) call add_card_error(set, bar_drawing, k, label)
            return
         end if
         call look_up(set, request_point, k, label, one)
         if (one == 0) cycle
         associate (list => joint_points(set, one), end_of => ends(label - label_a), m => set%mechanism)
            do i = 1, size(list)
               if (m%points(list(i))%link == n .and. m%points(list(i))%drawn) end_of = list(i)
            end do
            if (end_of == 0 .and. all(m%points(list)%link > 0)) call add_card_error(set, bar_joint, k, label)
         end associate
      end do

      ! A long name that goes on in the field of FROM has an error of its own.
      label = findloc(set%cards(k)%label(label_b:), '        ', dim=1)
      if (label > 0 .and. set%names_certain) call add_card_error(set, field_blank, k, label_a + label)
      if (any(ends == 0)) return
      associate (link => set%mechanism%links(n), p => set%mechanism%points(ends(1))%place, &
         q => set%mechanism%points(ends(2))%place)
         if (norm2(q - p) <= same_place_tolerance*(norm2(p) + norm2(q))) call add_card_error(set, bar_place, k, label_c)
         link%from = ends(1)
         link%to = ends(2)
         link%along = .not. set%cards(k)%given
      end associate
   end subroutine find_bar

   !> Finds the points that the card of a point defines: of a JOINT card both points, otherwise only the point itself.
   pure function joint_points(set, n) result(points)
      type(card_set_t), intent(in) :: set    !< the cards, and the mechanism made of them
      integer, intent(in) :: n               !< the number of the point
      integer, allocatable :: points(:)      !< (1 or 2) their numbers

      points = [n]
      associate (card => set%cards(set%named(request_point)%card(n)))
         if (card%form == form_joint) points = [card%subject, card%subject + 1]
      end associate
   end function joint_points

   !> Puts the name of a link, point, pair or measure from its card into the table of names. A name that another one of
   !> its kind has is an error; the name of a pair for a measure is an error, too. Two JOINT cards of one name have only
   !> one error: the error of their points.
   subroutine define_name(set, kind, n)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: kind            !< request_link, ..., request_measure
      integer, intent(in) :: n               !< number of the link, point, pair or measure
      integer :: k, other, earlier

      k = set%named(kind)%card(n)
      associate (name => set%cards(k)%label(name_field(set%cards(k)%form)))
         if (set%cards(k)%form /= form_joint) set%cards(k)%subject = n
         if (name == '') return
         call store_name(set%named(kind)%table, name, n, earlier)
         if (earlier > 0) earlier = set%named(kind)%card(earlier)
         if (kind == request_measure .and. earlier == 0) then
            earlier = find_name(set%named(request_pair)%table, name)
            if (earlier > 0) earlier = set%named(request_pair)%card(earlier)
         end if
      end associate
      if (earlier == 0) return
      if (kind == request_pair .and. all(set%cards([k, earlier])%form == form_joint)) return
      other = min(k, earlier)
      k = max(k, earlier)
      call add_card_error(set, name_repeated, k, name_field(set%cards(k)%form), whole(set%cards(other)%card%number))
   end subroutine define_name

   !> Tells whether a set has the coordinates of a drawing, in which a blank number is as drawn.
   pure logical function has_drawing(set)
      type(card_set_t), intent(in) :: set    !< the cards, and the mechanism made of them

      has_drawing = set%number_of(form_joint) > 0
   end function has_drawing

   !> Finds the link, point, pair or measure that a label of a card names. An unknown name is an error, unless a card
   !> that could define the name was not understood. A blank label finds nothing, without an error.
   subroutine look_up(set, kind, k, i, n)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: kind            !< request_link, ..., request_measure
      integer, intent(in) :: k               !< number of the card
      integer, intent(in) :: i               !< of the label: label_a to label_c
      integer, intent(out) :: n              !< number of the link, point, pair or measure; 0: none is found
      integer :: found

      call look_up_kinds(set, [kind], unknown(kind), k, i, found, n)
   end subroutine look_up

   !> Finds the link, point, pair or measure of one of several kinds that a label of a card names. An unknown name is an
   !> error, with a hint, unless a card that could define the name was not understood. A blank label finds nothing,
   !> without an error.
   subroutine look_up_kinds(set, kinds, code, k, i, kind, n)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: kinds(:)        !< (1 or more) request_link, ...: the first that has the name
      type(error_code_t), intent(in) :: code !< the error of an unknown name
      integer, intent(in) :: k               !< number of the card
      integer, intent(in) :: i               !< of the label: label_a to label_c
      integer, intent(out) :: kind           !< one of `kinds`
      integer, intent(out) :: n              !< number of the link, point, pair or measure; 0: none is found
      character(:), allocatable :: hint, word
      integer :: other, near, border, first, j

      n = 0
      kind = kinds(1)
      if (set%cards(k)%label(i) == '') return
      do j = 1, size(kinds)
         kind = kinds(j)
         n = find_name(set%named(kind)%table, set%cards(k)%label(i))
         if (n > 0) return
      end do
      if (.not. set%names_certain) return
      if (set%errors%count >= max_printed) then
         call add_card_error(set, code, k, i)
         return
      end if

      hint = ''
      do other = request_measure, request_link, -1
         if (find_name(set%named(other)%table, set%cards(k)%label(i)) > 0) &
            hint = '(A '//trim(words_of_kinds(other))//' HAS IT)'
      end do
      do j = 1, size(kinds)
         if (hint /= '') exit
         near = nearest_word(set%cards(k)%label(i), &
            [(subject_name(set%mechanism, kinds(j), other), other=1, size(set%named(kinds(j))%card))])
         if (near > 0) hint = near_name(subject_name(set%mechanism, kinds(j), near))
      end do

      ! A name that goes on in the next field, or that began in the field before, if none of its parts is a name.
      do border = i, min(i + 1, label_c)
         call find_long_label(set%cards(k)%card, border, first, word)
         if (word == '') cycle
         if (is_name(border - 1) .or. is_name(border)) cycle
         ! With a hint, a long label counts only if the label without its first letter, the end of the long label, is a
         ! name: the hint is then this name.
         if (hint /= '' .and. all([(find_name(set%named(kinds(j))%table, set%cards(k)%label(i)(2:)) == 0, &
            j=1, size(kinds))])) cycle
         call add_error(set%errors, label_long, set%cards(k)%card, card_fields(border - 1), first, word)
         set%names_certain = .false.
         return
      end do
      if (all(kinds == request_link) .and. set%number_of(form_ground) == 0) &
         hint = trim(hint//' (GIVE IT A GROUND OR LINK CARD; NO LINK IS GROUND)')
      call add_card_error(set, code, k, i, adjustl(hint))

   contains

      !> Tells whether a label of card `k` uses a name that another card defines.
      pure logical function is_name(label)
         integer, intent(in) :: label        !< label_a to label_c

         is_name = .false.
         if (any(definers%form == set%cards(k)%form .and. definers%label == label)) return
         is_name = any([(find_name(set%named(other)%table, set%cards(k)%label(label)) > 0, other=request_link, &
            request_measure)])
      end function is_name
   end subroutine look_up_kinds

   !> Finds label A of a card in a list of words. A label that is none of the words is an error, unless the card has
   !> another error.
   subroutine match_word(set, k, words, place)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: k               !< number of the card
      character(*), intent(in) :: words(:)   !< (1 or more) the words that are allowed
      integer, intent(out) :: place          !< index of the word in `words`; 0: none
      character(:), allocatable :: list
      integer :: i

      place = findloc(words, set%cards(k)%label(label_a), dim=1)
      if (place > 0 .or. .not. set%cards(k)%valid) return
      list = trim(words(1))
      do i = 2, size(words)
         list = list//', '//trim(words(i))
      end do
      call add_card_error(set, word_unknown, k, label_a, list)
   end subroutine match_word

   !> Adds a remark about a field of a card.
   subroutine add_card_remark(set, kind, k, field, value)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: kind            !< remark_title_long, ...
      integer, intent(in) :: k               !< number of the card
      integer, intent(in) :: field           !< card_name, label_a, ..., real_3
      character(*), intent(in), optional :: value   !< the end of the sentence, if it has one
      type(card_t) :: on
      type(field_t) :: at

      call find_field(set%cards(k), field, on, at)
      call add_remark(set%errors, kind, on, first_column(on, at), field_text(on, at), value)
   end subroutine add_card_remark

   !> Adds an error about a field of a card.
   subroutine add_card_error(set, code, k, field, more)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(error_code_t), intent(in) :: code !< the number and the sentence of the error
      integer, intent(in) :: k               !< number of the card
      integer, intent(in) :: field           !< card_name, label_a, ..., real_3
      character(*), intent(in), optional :: more   !< the end of the sentence, if it has one
      type(card_t) :: on
      type(field_t) :: at

      call find_field(set%cards(k), field, on, at)
      call add_field_error(set%errors, code, on, at, more)
   end subroutine add_card_error

   !> Gives the text of a real of a card, as it stands on the card, left-adjusted; '' for a blank field.
   pure function real_text(card, i) result(text)
      type(parsed_card_t), intent(in) :: card   !< a card of the set
      integer, intent(in) :: i               !< number of the real, 1 to 3
      character(real_length) :: text
      type(card_t) :: on
      type(field_t) :: at

      call find_field(card, label_c + i, on, at)
      text = on%text(first_column(on, at):at%last)
   end function real_text

   !> Finds the columns of a field, and the card on which they are: for a real of a `*` card, the `*` card.
   pure subroutine find_field(card, field, on, at)
      type(parsed_card_t), intent(in) :: card   !< a card of the set
      integer, intent(in) :: field           !< card_name, label_a, ..., real_3
      type(card_t), intent(out) :: on        !< the card itself or, for a real, the `*` card below it
      type(field_t), intent(out) :: at       !< its columns there

      on = card%card
      at = card_fields(field)
      if (.not. any(card%on_star .and. field == [real_1, real_2, real_3])) return
      on = card%star
      at = wide_fields(field - label_c)
   end subroutine find_field
end module card_sets
